#!/bin/bash
# Automatic exposure is one for the whole wall: the same for any number of tiles, with a tile missing, and from recorded states.
# shellcheck source=tests/support/tap.sh
. "$(dirname "$0")/../support/tap.sh"
make_scene "$folder/sheet.obj"
common=(--scene "$folder/sheet.obj" --set octree_depth=7 --quiet --size 120x72)
auto=(--set geometry=triangles --set exposure=auto --set tone=filmic --set dither=on --no-gaze)
long=(--frames 3 --step 0.1)
cd "$folder" || exit 1

sim() { # NAME CODE ARGUMENT...: into folder NAME
    local name=$1 code=$2
    shift 2
    timeout 300 "$program" sim "${common[@]}" --out "$name" --report "$name/report.json" "$@" >"$name.log" 2>&1
    is "sim $name ends as it should" $? "$code"
}

exposures() { # NAME: of each frame
    python3 -c 'import csv, sys
print(*[row["exposure"] for row in csv.DictReader(open(sys.argv[1]))])' "$1/frames.csv"
}

sim one 0 --tiles 1x1 "${auto[@]}" "${long[@]}" --save-states states.json
sim four 0 --tiles 2x2 "${auto[@]}" "${long[@]}"
sim six 0 --columns 31,40,49 --rows 50,22 "${auto[@]}" "${long[@]}"
for frame in 0000 0001 0002; do
    same_file "frame $frame of four tiles is that of one" four/wall-$frame.png one/wall-$frame.png
    same_file "frame $frame of six tiles is that of one" six/wall-$frame.png one/wall-$frame.png
done
is "four tiles have the exposure of one" "$(exposures four)" "$(exposures one)"
is "nothing is known of the first frame, then it stays where it belongs" \
    "$(exposures one | awk '{ print $1 == 0, $2 != 0, $3 == $2 }')" "1 1 1"
is "what ran is told" "$(json one/report.json '["effects"]["run"]' | grep -c "tone.*exposure.*dither.*metering")" 1
"$program" render "${common[@]}" "${auto[@]}" --out picture.png --report picture.json
is "one picture by itself ends where the wall does" "$(json picture.json '["image"]["hash"]')" "$(json one/report.json '["image"]["hash"]')"
is "and traced its rays once" "$(json picture.json '["counters"]["rays"]')" $((120 * 72))

told=$(timeout 300 "$program" sim --scene sheet.obj --set octree_depth=7 --size 120x72 "${auto[@]}" 2>&1 | tr '\n' ' ')
has "a single frame is not metered, and says so" "$told" "a single frame has none: it is drawn at 0 stops"
sim again 0 --tiles 3x1 --states states.json
same_file "frame 0002 from its state" again/wall-0002.png one/wall-0002.png
sim killed 1 --tiles 2x2 "${auto[@]}" "${long[@]}" --tile-fault kill:3@1
is "a tile that is gone keeps its say" "$(exposures killed)" "$(exposures one)"
finish
