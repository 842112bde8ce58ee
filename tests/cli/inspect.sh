#!/bin/bash
# gazewall inspect: what it says of scenes made here, of which every figure is known, and which options it takes.
# shellcheck source=tests/support/tap.sh
. "$(dirname "$0")/../support/tap.sh"

# A tetrahedron, closed; each of its faces again, turned over; one triangle of each sort that is dropped.
cat >"$folder/bad.obj" <<'OBJ'
v 0 0 0
v 1 0 0
v 0 1 0
v 0 0 1
v 2 0 0
v 1e12 0 0
v 1e12 1e9 0
v 1e12 0 1e9
v 1 1e-12 0
f 1 3 2
f 1 2 4
f 1 4 3
f 2 3 4
f 1 2 3
f 1 4 2
f 1 3 4
f 2 4 3
f 3 2 1
f 1 1 2
f 1 2 5
f 6 7 8
f 2 9 5
OBJ
expect "triangles are dropped by name" 0 \
    "1 with a repeated vertex, 1 without area, 1 far outside the scene, 1 collapsed by rounding, 1 equal to another" \
    inspect "$folder/bad.obj" --report "$folder/bad.json" --out "$folder/bad" --validate
is "they are in the report" "$(json "$folder/bad.json" '["scene"]["dropped"]')" \
    "{'non_finite': 0, 'bad_index': 0, 'repeated_vertex': 1, 'zero_area': 1, 'outlier': 1, 'collapsed': 1, 'duplicate': 1, 'not_triangle': 0}"
has "what to do about an outlier is a note" "$(json "$folder/bad.json" '["scene"]["notes"]')" "outlier_extents=0 keeps all"
is "what is left is a closed mesh, every face from both sides" \
    "$(json "$folder/bad.json" '["scene"]["mesh"]')" \
    "{'edges': 6, 'boundary_edges': 0, 'inconsistent_edges': 0, 'non_manifold_edges': 6, 't_junctions': 0, 'coincident': 4, 'coincident_turned': 4, 'coincident_materials': 0, 'slivers': 0, 'components': 1, 'closed_components': 1, 'closed_triangles': 8, 'inside_out': 0, 'largest_component': 8}"
is "leaves by level are all leaves" "$(json "$folder/bad.json" \
    '["octree"]["leaves"] - sum(l["leaves"] for l in d["octree"]["levels"])')" 0
is "leaves by length too" "$(json "$folder/bad.json" \
    '["octree"]["leaves"] - sum(l["leaves"] for l in d["octree"]["lists"])')" 0
is "nodes by level are all nodes" "$(json "$folder/bad.json" \
    '["octree"]["nodes"] - sum(l["leaves"] + l["inner"] for l in d["octree"]["levels"])')" 0
is "bytes on the GPU are those of the octree" "$(json "$folder/bad.json" \
    '["memory"]["gpu"]["nodes"] - d["octree"]["bytes"]["nodes"] - d["octree"]["bytes"]["leaves"]')" 0
is "the build needed some" "$(json "$folder/bad.json" '["memory"]["gpu"]["build_peak"] > 0')" True
is "the octree was validated" "$(json "$folder/bad.json" '["octree"]["validated"]')" True
same_file "--out has the same report" "$folder/bad/inspect.json" "$folder/bad.json"
for axis in x y z; do
    is "a picture along $axis" "$(head -c 8 "$folder/bad/levels_$axis.png" | od -An -tx1)" " 89 50 4e 47 0d 0a 1a 0a"
done

has "what frames decide is left open" "$(json "$folder/bad.json" '["effects"]["skipped"]')" \
    "'lod', 'why': 'each frame decides; none was drawn'"

# --- the naive rule loses the model
expect "without the rule the model collapses" 0 "collapsed by rounding" \
    inspect "$folder/bad.obj" --set outlier_extents=0 --report "$folder/naive.json"
is "only the far triangle is left" "$(json "$folder/naive.json" '["scene"]["triangles"]')" 1

# --- options
make_scene "$folder/sheet.obj"
expect "options of frames" 2 "unknown option '--eye'" inspect --eye 1,2,3
for option in --tau --seed --time --debug --gaze; do
    expect "$option draws" 2 "unknown option '$option'" inspect "$folder/sheet.obj" $option 1
done
expect "so does a setting of frames" 2 "--set geometry changes frames" inspect "$folder/sheet.obj" --set geometry=voxels
expect "a setting of the octree" 0 "depth 3 (deepest node 3)" inspect "$folder/sheet.obj" --set octree_depth=3
expect "the device and a scene" 2 "leave out the scene" inspect --device "$folder/sheet.obj"
expect "the device and an octree" 2 "leave out --set octree_depth" inspect --device --set octree_depth=4
expect "the device and its check" 2 "leave out the scene" inspect --device --validate
expect "a folder that cannot be" 5 "$folder/sheet.obj" inspect "$folder/sheet.obj" --out "$folder/sheet.obj/there"
expect "the device" 0 "division" inspect --device --report "$folder/device.json"
expect "a GPU that is not there" 3 "GPU 15" inspect --device --gpu 15
expect "a GPU that cannot be" 2 "0 to 15" inspect --device --gpu 16
if [ "$(json "$folder/device.json" '["device"]["gpus"].__len__() > 0')" = True ]; then
    expect "the last GPU of the list, by number" 0 "GPUs (--gpu N)" inspect --device --gpu "$(json "$folder/device.json" '["device"]["gpus"].__len__() - 1')"
fi
is "its floats are in the report" "$(json "$folder/device.json" '["float_environment"]["precise_holds"]')" True
finish
