#!/bin/bash
# A scene that moves: every rank rebuilds from the frame's time, without exchange, and any split has the same pixels.
# shellcheck source=tests/support/tap.sh
. "$(dirname "$0")/../support/tap.sh"
common=(--scene "$PWD/configs/scenes/moving.gltf" --set octree_depth=8 --quiet)
cd "$folder" || exit 1

sim() { # NAME ARGUMENT...: four frames into folder NAME
    local name=$1
    shift
    timeout 300 "$program" sim "${common[@]}" --out "$name" --report "$name/report.json" --frames 4 --gaze 60,40 \
        --time 0.25 --step 0.75 --set tau=4 "$@" >"$name.log" 2>&1
    local code=$?
    is "sim $name ends well" $code 0
    [ $code -eq 0 ] || sed 's/^/# /' "$name.log"
}

sim 1x1 --tiles 1x1 --size 121x67
sim 2x1 --tiles 2x1 --size 121x67
sim 2x2 --tiles 2x2 --size 121x67 --machines 2
for frame in 0000 0001 0002 0003; do
    same_file "frame $frame by two ranks" 2x1/wall-$frame.png 1x1/wall-$frame.png
    same_file "frame $frame by four ranks on two machines" 2x2/wall-$frame.png 1x1/wall-$frame.png
done
for frame in 0001 0002 0003; do
    is "frame $frame is another picture" "$(cmp -s 1x1/wall-$frame.png 1x1/wall-0000.png || echo differs)" differs
done
expect "render at the last frame's time" 0 "" render "${common[@]}" --size 121x67 --gaze 60,40 --set tau=4 --time 2.5 \
    --out render.png --report render.json
is "its pixels are the wall's" "$(json render.json '["image"]["hash"]')" "$(json 2x1/report.json '["image"]["hash"]')"
is "four frames, four rebuilds" "$(json 1x1/report.json '["rebuild"]["rebuilds"]')" 4
is "the pose at rest is another picture" "$("$program" render "${common[@]}" --size 121x67 --animation none --time 2.5 \
    --gaze 60,40 --set tau=4 --out rest.png && cmp -s rest.png render.png || echo differs)" differs
finish
