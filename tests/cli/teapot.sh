#!/bin/bash
# "A teapot in a stadium": the dragon of 871,306 triangles inside one cell of level 9 of the Sponza atrium, where both are
# fetched (tests/scenes.sh). A ray tests a bounded number of triangles; the plain list costs each ray all of them
# (docs/performance.md), so here it is only seen that there is one such list.
# shellcheck source=tests/support/tap.sh
. "$(dirname "$0")/../support/tap.sh"
models=$(cd "$(dirname "$0")/../.." && pwd)/out/scenes
if [ ! -e "$models/sponza/Sponza_LowPoly.gltf" ] || [ ! -e "$models/dragon/dragon_vrip.ply.gz" ]; then
    echo "1..0 # SKIP sponza or dragon is not fetched"
    exit 0
fi
cat >"$folder/teapot.yaml" <<YAML
version: 1
models:
  - file: $models/sponza/Sponza_LowPoly.gltf
  - {file: $models/dragon/dragon_vrip.ply.gz, unit: m, up: y, scale: 0.28, translate: [0.54875, 1.70824, -0.27698]}
placement: {viewpoint: true}
viewpoints:
  - {name: near, eye: [0.50, 1.78, -0.10], look_at: [0.5471, 1.74323, -0.278275], fov: 20}
YAML
"$program" render --quiet --no-gaze --scene "$folder/teapot.yaml" --viewpoint near --size 96x96 --count --set octree_depth=9 \
    --set geometry=triangles --report "$folder/teapot.json" >"$folder/log" 2>&1
is "it is drawn" $? 0
is "one cell holds the dragon" "$(json "$folder/teapot.json" '["octree"]["statistics"]["longest_list"] > 800000')" True
is "a ray tests fewer than 80 triangles" \
    "$(json "$folder/teapot.json" '["counters"]["triangle_tests"] < 80 * d["counters"]["rays"]')" True
is "and takes fewer than 250 steps" "$(json "$folder/teapot.json" '["counters"]["steps"] < 250 * d["counters"]["rays"]')" True
is "no ray is cut" "$(json "$folder/teapot.json" '["counters"]["step_cap_hits"]')" 0
finish
