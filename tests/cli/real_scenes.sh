#!/bin/bash
# Real scenes from out/scenes (tests/scenes.sh fetches them): the triangles that inspect counts, kept and dropped, must be
# those of the file, whatever the depth of their octree, which is small here. What is not fetched is skipped by name.
set -u
cd "$(dirname "$0")/../.." || exit 1
gazewall=${GAZEWALL:-$PWD/out/gazewall}
folder=${GW_TEST_FOLDER:-$(mktemp -d)}
report=$folder/report.json
number=0
failures=0

# A number out of the report, by its key; the first of that name stands in "scene".
value() {
    sed -n 's/.*"'"$1"'": *\([0-9]*\).*/\1/p' "$report" | head -n 1
}

# scene FILE KEPT DROPPED TEXTURES: drawn triangles, dropped ones but for points and lines, pictures.
scene() {
    local file=$1 kept=$2 dropped=$3 textures=$4 name got key dropped_now
    name="$file: $kept triangles, $dropped dropped, $textures textures"
    number=$((number + 1))
    if [ ! -e "$file" ]; then
        echo "ok $number - $name # SKIP not fetched"
        return
    fi
    if ! timeout -k 5 600 "$gazewall" inspect --quiet --set octree_depth=7 --report "$report" "$file" >"$folder/out" 2>&1 </dev/null; then
        echo "not ok $number - $name"
        sed 's/^/# /' "$folder/out" | tail -n 5
        failures=$((failures + 1))
        return
    fi
    dropped_now=0
    for key in non_finite bad_index repeated_vertex zero_area outlier collapsed duplicate; do
        dropped_now=$((dropped_now + $(value $key)))
    done
    got="$(value triangles) $dropped_now $(value textures)"
    if [ "$got" = "$kept $dropped $textures" ]; then
        echo "ok $number - $name"
    else
        echo "not ok $number - $name"
        echo "# kept, dropped, textures: $got"
        failures=$((failures + 1))
    fi
}

# file                                                               kept dropped textures
while read -r file kept dropped textures; do
    [ -n "$file" ] && scene "out/scenes/$file" "$kept" "$dropped" "$textures"
done <<'SCENES'
dragon/dragon_vrip.ply.gz                                            871306 108 0
dragon/dragon_vrip_res2.ply.gz                                       202520 0 0
dragon/dragon_vrip_res4.ply.gz                                       11102 0 0
sponza/Sponza_LowPoly.gltf                                           63069 15 0
testmodels/glTF2/2CylinderEngine-glTF-Binary/2CylinderEngine.glb     110336 11160 0
testmodels/glTF2/ClearCoat-glTF/ClearCoatTest.gltf                   37116 0 6
testmodels/glTF2/IndexOutOfRange/IndexOutOfRange.gltf                11 1 0
testmodels/glTF2/BoxTextured-glTF-Embedded/BoxTextured.gltf          12 0 1
testmodels/glTF2/textureTransform/TextureTransformTest.gltf          24 0 5
testmodels/PLY/Wuson.ply                                             3732 0 0
testmodels/PLY/cube_binary.ply                                       12 0 0
testmodels/STL/Spider_binary.stl                                     1312 56 0
testmodels/OFF/Wuson.off                                             3732 0 0
testmodels/OBJ/spider.obj                                            1312 56 4
draco/KhronosSampleModels/DragonAttenuation/glTF_Binary/DragonAttenuation.glb  134995 0 1
draco/CesiumMan/glTF/CesiumMan.gltf                                  4672 0 1
draco/Fox/glTF/Fox.gltf                                              576 0 1
draco/CesiumMilkTruck/glTF/CesiumMilkTruck.gltf                      3624 0 1
draco/InterpolationTest/glTF/InterpolationTest.gltf                  110 0 1
draco/simple_skin.gltf                                               8 0 0
draco/bun_zipper.ply                                                 69451 0 0
furniture/Scopia/scopia/japaneseMaple/japaneseMaple.obj              198396 0 1
furniture/Scopia/scopia/copperBeech/copperBeech.obj                  187308 0 1
furniture/Scopia/scopia/acacia/acacia.obj                            102889 275 1
furniture/BlendSwap-CC-BY/blendswap-cc-by/chessboard/chessboard.obj  125698 112 0
furniture/KatorLegaz/katorlegaz/concept-sedan-02/concept-sedan-02.obj 124188 0 0
furniture/Scopia/scopia/aquarium/aquarium.obj                        5622 0 4
supertuxkart/candela_city/candela_city.gltf                          430831 778 93
supertuxkart/ravenbridge_mansion/ravenbridge_mansion.gltf            273339 589 80
SCENES
echo "1..$number"
[ -n "${GW_TEST_FOLDER:-}" ] || rm -rf "$folder"
[ $failures -eq 0 ]
