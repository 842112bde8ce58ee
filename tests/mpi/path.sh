#!/bin/bash
# A wall that moves along a camera path: the same pictures in any split and from recorded states, one view after another,
# and what the path's own camera would show.
# shellcheck source=tests/support/tap.sh
. "$(dirname "$0")/../support/tap.sh"
make_scene "$folder/sheet.obj"
cd "$folder" || exit 1
cat >path.yaml <<END
version: 1
models: [{file: sheet.obj}]
paths:
  - {name: by, keys: [{time: 1, eye: [0, 1, 5], look_at: [0, 0, 0]}, {time: 3, eye: [3, 1, 4], look_at: [0, 0, 0]}]}
END
common=(--scene path.yaml --set octree_depth=6 --quiet)
size=(--size 90x50)

sim() { # NAME ARGUMENT...: into folder NAME
    local name=$1
    shift
    timeout 300 "$program" sim "${common[@]}" "${size[@]}" --out "$name" "$@" >"$name.log" 2>&1
    is "sim $name ends well" $? 0
}

view=(--path by --time 1 --no-gaze)
sim one --tiles 1x1 "${view[@]}" --frames 3 --report one.json
sim four --tiles 2x2 "${view[@]}" --frames 3 --save-states states.json
for frame in 0000 0001 0002; do
    same_file "frame $frame of four tiles is that of one" four/wall-$frame.png one/wall-$frame.png
done
is "every frame is another view" "$(sha1sum one/wall-000?.png | cut -d' ' -f1 | sort -u | wc -l)" 3
is "without a step they spread over the path" "$(cut -d, -f3 one/frames.csv | tail -n +2 | tr '\n' ' ')" "1.000000000 2.000000000 3.000000000 "
sim again --tiles 2x1 --states states.json
same_file "repeated from recorded states" again/wall-0001.png one/wall-0001.png
"$program" render "${common[@]}" "${size[@]}" --states states.json --frame 2 --out two.png --report two.json
is "render draws a recorded one" "$(json two.json '["image"]["hash"]')" "$(json one.json '["image"]["hash"]')"
sim still --tiles 1x1 --no-gaze
is "without a path the wall shows something else" "$(cmp -s still/wall.png one/wall.png; echo $?)" 1
expect "a path that is none" 2 "has no camera path 'up'; it has 1, the first is 'by'" sim "${common[@]}" --tiles 1x1 --path up
expect "a path beside states" 2 "leave out --path" sim "${common[@]}" --path by --states states.json
finish
