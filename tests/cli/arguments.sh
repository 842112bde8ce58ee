#!/bin/bash
# The command line: what helps, and that every mistake ends in one clear sentence and its exit code.
# shellcheck source=tests/support/tap.sh
. "$(dirname "$0")/../support/tap.sh"
root=$(cd "$(dirname "$0")/../.." && pwd)
make_scene "$folder/sheet.obj"
scene=(--scene "$folder/sheet.obj" --set octree_depth=5 --quiet)

# --- what helps
expect "alone it teaches" 0 "Try these:"
expect "help" 0 "Exit codes:" --help
expect "version" 0 "gazewall 0." --version
for verb in sim render inspect bench settings; do
    expect "help of $verb" 0 "Usage: gazewall $verb" $verb --help
done
expect "help tells units and defaults" 0 "default 960x540" sim --help
expect "help may stand anywhere" 0 "Usage: gazewall render" render --size 10x10 --help
expect "the table of settings" 0 "tau=1  (0 to 64 footprints)" settings
is "every setting is in it" "$("$program" settings | grep -c '; reference: ')" \
    "$(grep -c '^ *GW_ROW([a-z]' "$root/base/settings.h")"

# --- verbs and options
expect "a mistyped verb" 2 "unknown verb 'redner'; did you mean 'render'?" redner
expect "no such verb" 2 "unknown verb 'qqqqqqqq'; gazewall --help lists them" qqqqqqqq
expect "a mistyped option" 2 "unknown option '--frams'; did you mean '--frames'?" sim --frams 3
expect "a mistyped option with its value" 2 "did you mean '--size'?" render --sise=10x10
expect "no such option" 2 "unknown option '--zzzzzzzzzz'; --help lists the options" render --zzzzzzzzzz
expect "a short option" 2 "unknown option '-x'" render -x
expect "a word too many" 2 "'extra' is one word too many" settings extra
expect "an option without its value" 2 "option '--size' needs a value: --size WxH" render --size
expect "a value that does not belong" 2 "option '--no-gaze' takes no value" render --no-gaze=1
expect "a word that belongs nowhere" 2 "'model.obj' belongs to no option; a scene is given as --scene model.obj" render model.obj
expect "a rank by hand" 2 "start one of them" rank

# --- values
expect "a size in words" 2 "--size 'big' is not two whole numbers" render --size big
expect "half a size" 2 "--size '960x' is not two whole numbers" render --size 960x
expect "an empty size" 2 "--size '0x100' is out of range" render --size 0x100
expect "a huge size" 2 "both numbers must be 1 to 32768" render --size 99999x2
expect "no tiles" 2 "--tiles '0x2' is out of range" sim --tiles 0x2
expect "too many tiles" 2 "a wall has 1 to 64 tiles" sim --tiles 20x20
expect "more tiles than pixels" 2 "cannot be split into 8 columns" sim --tiles 8x1 --size 4x4
expect "columns against tiles" 2 "leave one of them out" sim --tiles 2x1 --columns 10,20,30
expect "columns against the size" 2 "--columns add up to 60 px, --size says 100" sim --size 100x50 --columns 10,20,30
expect "a column of no width" 2 "'0' is not a whole number from 1" sim --columns 10,0,30
expect "frames in words" 2 "--frames 'many' is not a whole number" sim --frames many
expect "no frames" 2 "--frames 0 is out of range; it must be 1 to 1000000" sim --frames 0
expect "a seed beyond its range" 2 "--seed 4294967296 is out of range" render --seed 4294967296
expect "a time that is no number" 2 "--time 'nan' is not a number" render --time nan
expect "a debug view that is none" 2 "did you mean 'levels'?" render --debug level
expect "a log level that is none" 2 "--log 'loud' is no level" render --log loud
expect "an unknown setting" 2 "tau_inside" render --set tau_insid=1
expect "a setting out of range" 2 "64" render --set tau=65
expect "a setting without value" 2 "--set" render --set tau
expect "tau out of range" 2 "--tau" render --tau -1
expect "a choice that is none" 2 "hybrid" render --set geometry=cubes
expect "half a point" 2 "--gaze '10' is not 2 numbers" render --gaze 10
expect "a point with too much" 2 "--eye '1,2,3,4' is not 3 numbers" render --eye 1,2,3,4 --look-at 0,0,0
expect "a gaze and none" 2 "leave out one of them" sim --gaze 10,20 --no-gaze
expect "none and a gaze" 2 "leave out one of them" render --no-gaze --gaze 10,20
expect "standing still for nothing" 2 "give --set accumulate=N, too" sim --still 1,1
expect "a camera before no wall" 2 "--wall-width is that of a wall" render --path 0 --wall-width 500
expect "a size that a bench cannot heed" 2 "bench scale has no use for --size" bench scale --size 64x64
expect "a path that a bench cannot heed" 2 "bench peers has no use for --path" bench peers --path 0
expect "half a camera" 2 "--eye and --look-at belong together" render --eye 1,2,3
expect "a field of view alone" 2 "--fov needs a camera" render --fov 40
expect "a field of view out of range" 2 "--fov 200 is out of range" render --eye 1,2,3 --look-at 0,0,0 --fov 200
expect "a camera without direction" 2 "the same point 1,2,3" render "${scene[@]}" --eye 1,2,3 --look-at 1,2,3
expect "a gaze beside the picture" 2 "pixel 500,20 is on no tile" render "${scene[@]}" --size 64x48 --gaze 500,20
expect "a viewpoint that is not there" 2 "has no viewpoint 'door'" render "${scene[@]}" --viewpoint door
expect "a track and a gaze" 2 "--track goes with neither" sim --track a.vrpn --gaze 1,2
expect "an effect that is none" 2 "there is no effect 'shadow'; did you mean 'shadows'?" render --forbid-effect shadow
expect "an effect that nothing is like" 2 "--force-effect: there is no effect 'zzz'" sim --force-effect zzz
expect "a bench that is none" 2 "did you mean 'build'?" bench biuld
expect "a bench of nothing" 2 "say what to measure" bench
expect "an animation of what stays" 2 "nothing in it moves, so no animation 'walk' can play" render "${scene[@]}" --animation walk
expect "a scene and the device" 2 "leave out the scene" inspect --device model.obj
expect "two scenes" 2 "'b.obj' is one scene too many" inspect a.obj b.obj

# --- files
expect "no such scene" 2 "nowhere.obj" render --scene "$folder/nowhere.obj"
expect "no such scene on the wall" 2 "nowhere.obj" sim --scene "$folder/nowhere.obj" --tiles 2x1 --size 64x48
expect "no such track on the wall" 2 "nowhere.vrpn" sim "${scene[@]}" --track "$folder/nowhere.vrpn" --tiles 2x1 --size 64x48
expect "a setting beside states" 2 "leave out tau=3" render "${scene[@]}" --states "$folder/nowhere.json" --set tau=3
expect "a debug view beside states" 2 "leave out --debug" sim "${scene[@]}" --states "$folder/nowhere.json" --debug levels
expect "a map beside the exact picture" 2 "leave out one of them" render "${scene[@]}" --triple "$folder/triple" --debug levels
expect "no such states" 2 "nowhere.json" render "${scene[@]}" --states "$folder/nowhere.json"
echo '{"gazewall": 1}' >"$folder/other.json"
expect "states that are none" 2 "other.json:1: no recording of frame states" render "${scene[@]}" --states "$folder/other.json"
printf '{"gazewall_states": 1}\n{"frame": 0, "time": 0, "seed": 0, "epoch": 0, "accumulate": 1, "eye": [0, 0]}\n' >"$folder/short.json"
expect "a state with half an eye" 2 "short.json:2: 'eye' is missing or not three numbers" render "${scene[@]}" --states "$folder/short.json"
expect "a picture that cannot be written" 5 "$folder/nowhere/a.png" render "${scene[@]}" --size 32x32 --out "$folder/nowhere/a.png"
expect "a report that cannot be written" 5 "$folder/nowhere/r.json" render "${scene[@]}" --size 32x32 --report "$folder/nowhere/r.json"
: >"$folder/file"
expect "it is told before the scene is read" 5 "$folder/nowhere/a.png" render --scene missing.obj --out "$folder/nowhere/a.png"
expect "a folder in the picture's place" 5 "Is a directory" render --scene missing.obj --out "$folder"
expect "so is a gaze beside the picture" 2 "pixel 200,20 is on no tile" render --scene missing.obj --size 64x48 --gaze 200,20
expect "states that cannot be written" 5 "$folder/nowhere/s" sim --scene missing.obj --save-states "$folder/nowhere/s"
expect "results of a bench below a file" 5 "$folder/file" bench build --scene missing.obj --out "$folder/file/results"
is "a quiet bench is quiet" "$("$program" bench build --quick "${scene[@]}" 2>&1)" ""
cat >"$folder/path.yaml" <<EOF
version: 1
models: [{file: $root/tests/data/box.obj}]
paths:
  - {name: round, fov: 50, keys: [{time: 0, eye: [0, 2, 6], look_at: [0, 0, 0]}, {time: 9, eye: [5, 2, 4], look_at: [0, 0, 0]}]}
EOF
head -2 "$folder/path.yaml" >"$folder/no-path.yaml"
on_path=(--scene "$folder/path.yaml" --set octree_depth=5 --quiet)
# One model and the same effects: most of their time goes into translating kernels.
unshadowed=(--point-light --forbid-effect shadows)
"$program" bench modes --quick --size 96x54 --repeats 1 --scene "$folder/no-path.yaml" "${on_path[@]:2}" "${unshadowed[@]}" --out "$folder/modes"
is "seven modes" "$(wc -l <"$folder/modes/modes.csv")" 8
is "triangles and exact do the same work" \
    "$(json "$folder/modes/modes.json" '["bench"]["modes"][0]["counters"] == d["bench"]["modes"][1]["counters"]')" True
is "voxels test no triangles" "$(json "$folder/modes/modes.json" '["bench"]["modes"][2]["counters"]["triangle_tests"]')" 0
is "errors are between 0 and 1, and filters hide some" \
    "$(json "$folder/modes/modes.json" '["bench"]["modes"] and all(0 <= m["seen_flip"] <= m["flip"] + 0.01 <= 1 for m in d["bench"]["modes"])')" True
is "without a path there is no flicker" "$(json "$folder/modes/modes.json" '["bench"]["modes"][3]["flicker"]')" None
"$program" bench modes --quick --size 48x48 --frames 3 "${on_path[@]}" "${unshadowed[@]}" --path round --out "$folder/along"
is "three frames of a path" "$(json "$folder/along/modes.json" '["bench"]["path"], len(d["bench"]["modes"][0]["ms"])')" "('round', 3)"
is "flicker of modes that alias" \
    "$(json "$folder/along/modes.json" '["bench"] and all(0 < m["flicker"]["mean"] < m["flicker"]["largest"] for m in d["bench"]["modes"])')" True
is "verdicts and plotted times" "$(json "$folder/along/modes.json" '["bench"]["verdicts"].__len__()') $(ls "$folder/along/modes-time.svg")" \
    "3 $folder/along/modes-time.svg"
"$program" bench modes --quick --size 48x48 --frames 1 "${on_path[@]}" --point-light --density 20 --times-only --out "$folder/point"
is "one shadow ray for one light, where anything is lit" \
    "$(json "$folder/point/modes.json" '["bench"]["modes"][0]["counters"] and 0 < d["bench"]["modes"][0]["counters"]["shadow_rays"] <= 48 * 48')" True
is "none where shadows are forbidden" "$(json "$folder/along/modes.json" '["bench"]["modes"][0]["counters"]["shadow_rays"]')" 0
is "a path seen as finely as a wall, and times only" \
    "$(json "$folder/point/modes.json" '["bench"] and (round(d["bench"]["pixels_per_degree"], 2), d["bench"]["modes"][0]["flip"])')" "(20.0, None)"
is "with nothing in the columns that were not measured" "$(sed -n 2p "$folder/point/modes.csv" | grep -o ',*$')" ",,,,,,,,"
expect "a density without a path" 2 "has none: add one under 'paths'" bench modes "${scene[@]}" --density 20
expect "a density that is not heeded" 2 "no use for --density" bench build "${scene[@]}" --density 20
expect "a path that is none" 2 "has no camera path 'walk'; it has 1, the first is 'round'" bench modes "${on_path[@]}" --path walk
"$program" render "${on_path[@]}" --path round --time 9 --size 32x32 --out "$folder/on-path.png"
"$program" render "${on_path[@]}" --eye 5,2,4 --look-at 0,0,0 --fov 50 --size 32x32 --out "$folder/eye.png"
is "a picture on a path is that of a camera there" "$(cmp "$folder/on-path.png" "$folder/eye.png" 2>&1)" ""
expect "two cameras" 2 "leave out --viewpoint" render "${on_path[@]}" --path 0 --viewpoint 0
expect "exact, approximate, difference, seen" 0 "seen by who looks there" render --scene "$folder/path.yaml" --set octree_depth=5 \
    --path 0 --size 48x40 --gaze 8,8 --tau 8 --triple "$folder/triple" --report "$folder/triple.json"
is "four of them side by side" "$(od -An -tu4 --endian=big -j16 -N8 "$folder/triple/triple.png" | tr -s ' ')" " 192 40"
is "they differ, and it is told" "$(json "$folder/triple.json" '["triple"] and 0 < d["triple"]["seen_flip"] <= d["triple"]["flip"] < 1')" True
"$program" render "${on_path[@]}" --path 0 --size 48x40 --samples 16 --triple "$folder/equal" --report "$folder/equal.json"
is "what is exact does not differ from itself" \
    "$(json "$folder/equal.json" '["triple"]["flip"], d["triple"]["seen_flip"]') $([ -e "$folder/equal/seen.png" ] || echo none)" "(0.0, None) none"
"$program" bench layouts --quick --size 32x32 --repeats 1 "${scene[@]}" --out "$folder/layouts"
is "layouts that were compared" $? 0
is "they are in the report" "$(json "$folder/layouts/layouts.json" '["bench"]["layouts"][8]["name"]')" "seed64"
is "with the reason where one was skipped" \
    "$(json "$folder/layouts/layouts.json" '["bench"]["layouts"][12]["skipped"].count("deeper than 5 levels")')" 1
is "and fourteen of them in the table" "$(grep -c '^[a-z0-9-]*,[0-9]' "$folder/layouts/layouts.csv")" 14
mkfifo "$folder/fifo"
timeout 60 cat "$folder/fifo" >"$folder/through" &
expect "a picture through a FIFO" 0 "" render "${scene[@]}" --size 8x8 --out "$folder/fifo"
wait $!
is "it stays one" "$([ -p "$folder/fifo" ] && echo fifo) $(head -c 4 "$folder/through" | tail -c 3)" "fifo PNG"
expect "pictures below a file" 5 "$folder/file" sim "${scene[@]}" --tiles 1x1 --size 32x32 --out "$folder/file/pictures"
expect "no such shaders" 2 "nowhere" render "${scene[@]}" --size 32x32 --shaders "$folder/nowhere"
if [ -c /dev/full ]; then
    timeout 60 "$program" settings >/dev/full 2>"$folder/full"
    is "standard output that is full" $? 5
    has "it says so" "$(cat "$folder/full")" "standard output could not be written: No space left"
fi
(sleep 1; "$program" settings 2>"$folder/pipe"; echo "code $?" >>"$folder/pipe") | true
is "a reader that has seen enough is told nothing, its script is" "$(cat "$folder/pipe")" "code 5"

# --- the cache of octrees
cached() {
    "$program" render "${scene[@]}" --size 32x32 --cache "$folder/cache" --report "$folder/cached.json" >/dev/null 2>"$folder/cached.log"
    json "$folder/cached.json" '["build"]["partition"] + " " + d["image"]["hash"]'
}
first=$(cached)
has "the first run builds" "$first" "rank 0 "
is "the second reads, with the same pixels" "$(cached)" "cache ${first#rank 0 }"
octree=$(find "$folder/cache" -name '*.gwo')
printf 'x' | dd of="$octree" bs=1 seek=300 conv=notrunc 2>/dev/null
scene=("${scene[@]:0:4}")
is "a damaged one is built again" "$(cached)" "$first"
has "it says so" "$(cat "$folder/cached.log")" "the octree is built again"
is "and mended" "$(cached)" "cache ${first#rank 0 }"
scene+=(--quiet)

# --- sites
site() { # NAME PART-OF-MESSAGE, the file on standard input
    local file=$folder/site-$number.yaml
    cat >"$file"
    expect "$1" 2 "$2" sim "${scene[@]}" --site "$file"
}
expect "no such site" 2 "nowhere.yaml" sim --site "$folder/nowhere.yaml"
expect "a site and a split" 2 "--site describes the whole wall" sim --site "$root/configs/sites/2x2.yaml" --tiles 2x2
site "a site of another version" "'version'" <<<'version: 2'
site "a site without tiles" "this one has 0 of them" <<<'version: 1'
site "a mistyped key" "columns" <<'Y'
version: 1
grid: {colums: 2, rows: 1, tile: {width: 100, height: 100, pixels: [10, 10]}}
Y
site "a grid without its tile" "key 'tile' is missing here" <<'Y'
version: 1
grid: {columns: 2, rows: 1}
Y
site "a tile without pixels" ":2: key 'pixels' is missing here" <<'Y'
version: 1
grid: {columns: 2, rows: 1, tile: {width: 100, height: 100}}
Y
site "too many tiles in a grid" "a wall has 1 to 64 tiles" <<'Y'
version: 1
grid: {columns: 9, rows: 9, tile: {width: 100, height: 100, pixels: [10, 10]}}
Y
site "two corners" "expected three, in mm" <<'Y'
version: 1
tiles: [{name: a, pixels: [10, 10], place: [0, 0], corners: [[0, 0, 0], [100, 0, 0]]}]
Y
site "corners in a line" "meet at" <<'Y'
version: 1
tiles: [{name: a, pixels: [10, 10], place: [0, 0], corners: [[0, 0, 0], [100, 0, 0], [200, 0, 0]]}]
Y
site "two tiles of one name" "is a tile in line 3 already" <<'Y'
version: 1
tiles:
  - {name: a, pixels: [10, 10], place: [0, 0], corners: [[0, 0, 0], [100, 0, 0], [0, -100, 0]]}
  - {name: a, pixels: [10, 10], place: [10, 0], corners: [[100, 0, 0], [200, 0, 0], [100, -100, 0]]}
Y
site "two tiles in one place" ":4: tile 'b' overlaps tile 'a'" <<'Y'
version: 1
tiles:
  - {name: a, pixels: [10, 10], place: [0, 0], corners: [[0, 0, 0], [100, 0, 0], [0, -100, 0]]}
  - {name: b, pixels: [10, 10], place: [5, 0], corners: [[100, 0, 0], [200, 0, 0], [100, -100, 0]]}
Y
site "a name that is a path" "has a character that cannot be here" <<'Y'
version: 1
tiles: [{name: ../a, pixels: [10, 10], place: [0, 0], corners: [[0, 0, 0], [100, 0, 0], [0, -100, 0]]}]
Y
finish
