#!/bin/bash
# gazewall bench effects: the price list of a small scene.
cd "$(dirname "$0")/../.." || exit 1
. tests/support/tap.sh

make_scene "$folder/sheet.obj"
expect "the price list of a small scene" 0 "cheap: below 2 %" bench effects "$folder/sheet.obj" --quick --size 16x16 \
    --set octree_depth=5 --set tau=0 --set sample_block=1 --out "$folder/results"
csv=$folder/results/effects.csv
is "columns" "$(awk -F, '{print NF}' "$csv" | sort -u)" 24
is "both qualities have a row for all that is unused" "$(grep -c ',all unused,0,' "$csv")" 2
is "what nothing calls for changes no pixel" "$(awk -F, '$4 == 0 && $24 != 0' "$csv")" ""
is "what nothing calls for traces no ray" "$(awk -F, '$4 == 0 && ($5 != $6 || $7 != $8)' "$csv")" ""
is "without shadows there are no shadow rays" \
    "$(awk -F, '$3 == "shadows" { print ($7 > 0 && $8 == 0 ? "yes" : $0) }' "$csv" | sort -u)" yes
is "the chart is well-formed" "$(python3 -c 'import sys, xml.dom.minidom
print(xml.dom.minidom.parse(sys.argv[1]).documentElement.tagName)' "$folder/results/effects.svg" 2>&1)" svg
expect "more rounds than it takes" 2 "64 times at most" bench effects --repeats 65 "$folder/sheet.obj"

finish
