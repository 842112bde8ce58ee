#!/bin/bash
# Draws scenes beside Blender's Cycles and says how far apart the pictures are (docs/comparison.md).
#   tests/compare_cycles.sh [NAME...]     names: those of tests/compare/scenes; all when none is given
# Each NAME has a folder out/compare/NAME: ours-*.png, cycles-*.png, limited.jpg and gi.jpg (ours, Cycles, FLIP),
# figures.json. At the end comes the table of all folders. Variables: SIZE (240x180), OURS (16 samples a pixel),
# CYCLES (64), REUSE=1 keeps Cycles' pictures where they are. Needs Blender and two Python modules for it
# (.ci/setup compare), which nothing else does, and the scenes that tests/scenes.sh fetches.
set -u
cd "$(dirname "$0")/.." || exit 1
size=${SIZE:-240x180}
program=${PROGRAM:-out/gazewall}
compare=${TOOL:-out/release/tests/tools/compare_pictures}
folder=$PWD/out/compare
common=(--viewpoint 0 --size "$size" --tau 0 --cache none --quiet)
quality=(--samples 4 --set accumulate="$((${OURS:-16} / 4))" --set shadow_samples=1 --set environment_lights=8 --set occlusion_cones=3
    --set occlusion_distance=2)
failed=0

if ! command -v blender >/dev/null; then
    echo "Blender is not installed: .ci/setup compare installs it"
    exit 3
fi
for file in "$program" "$compare"; do
    [ -x "$file" ] || {
        echo "build first: make all tools"
        exit 3
    }
done

draw_ours() { # NAME SCENE
    local out=$folder/$1 kind
    "$program" render --scene "$2" "${common[@]}" --debug levels --out "$out/ours-levels.png" || return 1
    for kind in limited gi; do
        local more=()
        [ "$kind" = gi ] && more=(--set diffuse_bounce=all)
        TIMEFORMAT='%U %S'
        { time "$program" render --scene "$2" "${common[@]}" "${quality[@]}" "${more[@]}" --report "$out/ours-$kind.json" \
            --out "$out/ours-$kind.png" 2>&3; } 3>&2 2>"$out/ours-$kind.seconds" || return 1
    done
}

draw_theirs() { # NAME SCENE
    [ -n "${REUSE:-}" ] && [ -e "$folder/$1/cycles.json" ] && return
    blender -b -noaudio --python-exit-code 1 -P tests/compare/cycles.py -- "$2" "$size" "${CYCLES:-64}" \
        "$folder/$1" >"$folder/$1/blender.log" 2>&1 || {
        tail -n 15 "$folder/$1/blender.log"
        return 1
    }
}

compare_all() { # NAME
    local out=$folder/$1 kind
    for kind in limited gi; do
        "$compare" "$out/ours-$kind.png" "$out/cycles-$kind.png" "$out/$kind.jpg" "$out/ours-levels.png" \
            "$out/cycles-mask.png" >"$out/$kind.json" || return 1
    done
}

mkdir -p "$folder"
[ -e "$folder/studio.hdr" ] || python3 tests/compare/make_studio.py "$folder/studio.hdr" || exit 1
names=("$@")
if [ $# -eq 0 ]; then
    mapfile -t names < <(basename -s .yaml tests/compare/scenes/*.yaml)
fi
for name in "${names[@]}"; do
    scene=tests/compare/scenes/$name.yaml
    mkdir -p "$folder/$name"
    echo "$name"
    if ! { draw_ours "$name" "$scene" && draw_theirs "$name" "$scene" && compare_all "$name"; }; then
        echo "$name: not compared"
        failed=1
    fi
done
python3 tests/compare/table.py "$folder"
exit $failed
