#!/bin/bash
# gazewall bench table2 on a small scene: rows, their arithmetic and their order. bench growth: work in proportion.
# bench voxelise: differences add up. bench scale, bench aliasing: walls, cities.
cd "$(dirname "$0")/../.." || exit 1
. tests/support/tap.sh

make_scene "$folder/sheet.obj"
run=(bench table2 --quick --out "$folder/results")
expect "table 2 of two scenes" 0 "Happy Buddha" "${run[@]}" "$folder/sheet.obj" "$folder/sheet.obj"
csv=$folder/results/table2.csv
is "a header and six rows for each scene" "$(wc -l <"$csv")" 13
is "columns" "$(awk -F, '{print NF}' "$csv" | sort -u)" 17
# scene triangles row depth inner leaves nodes references voxels triangles saved_all saved_tree ...
is "the paper's node keeps all eight children, its voxel takes 16 bytes" \
    "$(awk -F, 'NR > 1 && /paper.s node/ && ($7 != 8 * (1 + 8 * $5) || $9 != 16 * ($5 + $6))' "$csv")" ""
is "ours keeps those there are" "$(awk -F, 'NR > 1 && !/paper.s node/ && $7 != 8 * ($5 + $6)' "$csv")" ""
is "refined everywhere has most nodes, our rules fewest" \
    "$(awk -F, 'NR >= 4 && NR <= 6 { if (last && $5 + $6 >= last) print "row", NR; last = $5 + $6 }' "$csv")" ""
is "every leaf of the tree refined everywhere is at the limit" \
    "$(json "$folder/results/table2.json" '["bench"]["scenes"][0]["rows"][2]["depth"]')" 6
is "savings are of the row refined everywhere" "$(awk -F, '
    NR == 2 { all = $7 + $8 + $9 + $10 }
    NR == 3 { d = 100 * (1 - ($7 + $8 + $9 + $10) / all) - $11; print (d < 0.001 && d > -0.001 ? "yes" : d) }' "$csv")" yes
expect "a scene that is not there" 2 "missing.obj" "${run[@]}" "$folder/missing.obj"
expect "too many scenes" 2 "one scene too many" bench table2 $(seq 65)
expect "scenes for a bench that takes one" 2 "one word too many" bench build a.obj

expect "growth to 300 thousand triangles" 0 "fitted exponents" bench growth --quick --out "$folder/results"
is "four sizes" "$(awk -F, 'NR > 1 { print $1 }' "$folder/results/growth.csv" | tr '\n' ' ')" "10092 30000 101568 303372 "
for quantity in overlap_tests nodes bytes; do
    exponent=$(json "$folder/results/growth.json" "['bench']['exponents']['$quantity']")
    is "$quantity grow in proportion, within a tenth" \
        "$(awk -v e="$exponent" 'BEGIN { print (e > 0.9 && e < 1.1 ? "yes" : e) }')" yes
done
for plot in time bytes; do
    is "the plot of $plot is well-formed" "$(python3 -c 'import sys, xml.dom.minidom
print(xml.dom.minidom.parse(sys.argv[1]).documentElement.tagName)' "$folder/results/growth-$plot.svg" 2>&1)" svg
done
expect "walls of more and more tiles" 0 "for each doubling" bench scale --quick --scene "$folder/sheet.obj" --set octree_depth=10 \
    --out "$folder/results"
is "every tile of four walls" "$(wc -l <"$folder/results/scale.csv")" 57
is "the larger the wall, the smaller the share of the rays" \
    "$(json "$folder/results/scale.json" '["bench"]["walls"][3]["share"]["rays"] < 0.3 < d["bench"]["walls"][1]["share"]["rays"]')" True
is "a full frame has a ray for each pixel" \
    "$(json "$folder/results/scale.json" '["bench"]["walls"][3]["full"]["rays"] == 35 * 240 * 135')" True
is "a ray's work grows with the logarithm" \
    "$(json "$folder/results/scale.json" '["bench"]["growth"]["fits"]["node_loads"]["determination"] > 0.9')" True
is "far below any root" \
    "$(json "$folder/results/scale.json" '["bench"]["growth"]["fits"]["node_loads"]["exponent"] < 0.2')" True
is "plotted" "$(grep -c "</svg>" "$folder/results/scale-growth.svg" "$folder/results/scale-tiles.svg" | cut -d: -f2 | tr -d "\n")" 11
expect "a city seen whole in few pixels" 0 "hybrid below triangles only in error and flicker: met" bench aliasing --quick \
    --out "$folder/results"
is "voxels halve its flicker" \
    "$(json "$folder/results/aliasing.json" '["bench"]["scenes"][0]["modes"][2]["flicker"]["mean"] < 0.5 * d["bench"]["scenes"][0]["modes"][0]["flicker"]["mean"]')" True
is "much of it is voxels then" \
    "$(json "$folder/results/aliasing.json" '["bench"]["scenes"][0]["modes"][2]["voxel_share"] > 0.2')" True
is "a row for each mode" "$(wc -l <"$folder/results/aliasing.csv")" 4
"$program" bench aliasing --quick --quiet --set tau=0 --out "$folder/exact"
is "with tau 0 it is what triangles are" \
    "$(json "$folder/exact/aliasing.json" '["bench"]["scenes"][0]["modes"][2]["rms"] == d["bench"]["scenes"][0]["modes"][0]["rms"]')" True
expect "a scene for growth" 2 "makes its own scenes" bench growth --scene a.obj

# --- resident: every model has the picture that it has alone
expect "four rocks at once" 0 "all 4" bench resident --quick --out "$folder/results"
is "their bytes are those of the model" "$(json "$folder/results/resident.json" \
    '["bench"]["model"]["flagged"] == 0 and 0.9 < d["bench"]["model"]["worst"] < 1.1')" True
is "a header, four rows and their sum" "$(wc -l <"$folder/results/resident.csv")" 6
is "bytes add up" "$(awk -F, 'NR > 1 && NR < 6 { sum += $3 + $4 + $5 + $6 + $7 + $8 + $9 }
    NR == 6 { print sum - $3 - $4 - $5 - $6 - $7 - $8 - $9 }' "$folder/results/resident.csv")" 0
"$program" bench resident --quick --quiet configs/scenes/moving.gltf "$folder/sheet.obj" --out "$folder/both"
"$program" bench resident --quick --quiet "$folder/sheet.obj" --out "$folder/one"
is "beside another model" "$(json "$folder/both/resident.json" '["bench"]["models"][1]["picture"]')" \
    "$(json "$folder/one/resident.json" '["bench"]["models"][0]["picture"]')"
is "which is another picture" "$(json "$folder/both/resident.json" '["bench"]["models"][0]["picture"] != d["bench"]["models"][1]["picture"]')" True

# --- rebuild
expect "rebuilds of what moves" 0 "all rebuilds have the bytes of builds" bench rebuild --quick --set octree_depth=7 \
    --scene configs/scenes/moving.gltf --out "$folder/results"
is "the second time nothing is made" "$(json "$folder/results/rebuild.json" '["bench"]["rounds"][2]["buffers_made"]')" 0
is "four poses" "$(wc -l <"$folder/results/rebuild.csv")" 5
expect "rebuilds of what stays" 2 "nothing in it moves" bench rebuild --quick --scene "$folder/sheet.obj"

expect "the rasterised voxeliser" 0 "rasteriser alone" bench voxelise --quick --scene "$folder/sheet.obj" \
    --out "$folder/results"
# depth refined rasterised fragments both other_depth thinner no_fragment margin beside
is "its differences add up" "$(awk -F, 'NR == 2 && ($5 == 0 || $5 + $6 + $7 + $8 + $9 != $2 || $5 + $10 != $3)' \
    "$folder/results/voxelise.csv")" ""
is "the paper's loop keeps eight children of every inner node" "$(json "$folder/results/voxelise.json" \
    '["bench"]["paper_loop"]["nodes"] == 1 + 8 * d["bench"]["paper_loop"]["inner"]')" True
finish
