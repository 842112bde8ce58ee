#!/bin/bash
# Accumulation over a wall: equal numbers of samples of a still view are the same picture, by any number of tiles, drawn
# one by one or at once, live or from recorded states; without it a still gaze is a still picture.
# shellcheck source=tests/support/tap.sh
. "$(dirname "$0")/../support/tap.sh"
make_scene "$folder/sheet.obj"
common=(--scene "$folder/sheet.obj" --set octree_depth=7 --quiet)
cd "$folder" || exit 1
size=(--size 161x97)
view=(--gaze "50,40")

sim() { # NAME ARGUMENT...: into folder NAME
    local name=$1
    shift
    timeout 300 "$program" sim "${common[@]}" "${size[@]}" --out "$name" --report "$name/report.json" "$@" >"$name.log" 2>&1
    is "sim $name ends well" $? 0
}

picture() { # SAMPLES ARGUMENT...: the hash of render's picture of so many samples
    local samples=$1
    shift
    "$program" render "${common[@]}" "${size[@]}" --set "accumulate=$samples" --out picture.png --report picture.json "$@" &&
        json picture.json '["image"]["hash"]'
}

hash_of() {
    json "$1/report.json" '["image"]["hash"]'
}

sim one --tiles 1x1 "${view[@]}" --frames 6 --set accumulate=4
sim four --tiles 2x2 "${view[@]}" --frames 6 --set accumulate=4 --save-states states.json
for frame in 0000 0001 0002 0003 0004 0005; do
    same_file "frame $frame of four tiles is that of one" four/wall-$frame.png one/wall-$frame.png
done
first=$(picture 1 "${view[@]}")
fourth=$(picture 4 "${view[@]}")
is "six frames of at most four samples are four at once" "$(hash_of one)" "$fourth"
is "which is not the picture of one" "$([ "$first" != "$fourth" ] && echo differs)" differs
is "a full view costs no further ray" "$(json one/report.json '["counters"]["rays"]')" "$(json picture.json '["counters"]["rays"]')"
is "the report names what ran" "$(json one/report.json '["effects"]["run"].count("accumulation")')" 1
is "rows count the samples" "$(cut -d, -f15,16 one/frames.csv | tr '\n' ' ')" "epoch,accumulate 1,1 1,2 1,3 1,4 1,4 1,4 "

sim again --tiles 3x1 --states states.json
for frame in 0001 0003; do
    same_file "frame $frame from its state" again/wall-$frame.png one/wall-$frame.png
done
# A recording that begins in the middle: all samples that are lacking are drawn.
{
    head -1 states.json
    sed -n 4p states.json
} >middle.json
sim middle --tiles 2x1 --states middle.json
is "a start at the third sample" "$(hash_of middle)" "$(picture 3 "${view[@]}")"

sim moving --tiles 1x1 --frames 3 --set accumulate=4
is "a view that moves starts anew each frame" "$(cut -d, -f15,16 moving/frames.csv | tail -3 | tr '\n' ' ')" "1,1 2,1 3,1 "
sim held --tiles 1x1 --frames 3 --step 0.01 --still 30,5 --set accumulate=4 --save-states held.json
is "but not if it moves little and that counts as still" "$(cut -d, -f15,16 held/frames.csv | tail -3 | tr '\n' ' ')" "1,1 1,2 1,3 "
sim held-again --tiles 2x1 --states held.json
same_file "which its states repeat" held-again/wall-0002.png held/wall-0002.png
expect "bounds of standing still" 2 "--still '200,1' is out of range" sim --still 200,1
sim off --tiles 2x1 "${view[@]}" --frames 2
is "without it a still gaze is a still picture" "$(hash_of off)" "$first"
is "and nothing ran for it" "$(json off/report.json '["effects"]["run"].count("accumulation")')" 0
finish
