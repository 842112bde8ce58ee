#!/bin/bash
# The verb check: verdict, table, warnings, printed corners, drawing, exit codes.
# shellcheck source=tests/support/tap.sh
. "$(dirname "$0")/../support/tap.sh"
root=$(cd "$(dirname "$0")/../.." && pwd)

for site in desktop 2x2 3x2-bezels 35-panels curved-5x1 cave-corner; do
    expect "$site is good" 0 "$site is good" check $site
    "$program" check "$root/configs/sites/$site.yaml" --corners >"$folder/corners.yaml"
    "$program" check "$folder/corners.yaml" --corners | same_file "$site: corners of corners" - "$folder/corners.yaml"
done
expect "help names the exit codes" 0 "2 it cannot" check --help
expect "what was understood: pixels and millimetres" 0 "1018.1 x 572.7" check 3x2-bezels
expect "pixels per degree at the eye" 0 "c1r0  -     1018.1 x 572.7     320x180         3.182       13.8  mono" \
    check 3x2-bezels
is "a row for each tile" "$("$program" check 35-panels | grep -c 1920x1080)" 35

sed 's/height: 572.7/height: 600/' "$root/configs/sites/3x2-bezels.yaml" >"$folder/odd.yaml"
expect "a warning is told with its line" 0 "odd.yaml:5: tile 'c0r0' has pixels of 3.182 x 3.333 mm" check "$folder/odd.yaml"
expect "and counted" 0 "can be used; 1 warning" check "$folder/odd.yaml"
expect "strictly, it is an error" 2 "1 warnings, and --strict" check "$folder/odd.yaml" --strict
expect "quiet leaves only warnings" 0 "warning: " check "$folder/odd.yaml" --quiet
is "and nothing else" "$("$program" check "$folder/odd.yaml" --quiet 2>/dev/null)" ""
expect "the wall's verb warns, too" 0 "odd.yaml:5: tile 'c0r0' has pixels" wall --site "$folder/odd.yaml" --dry-run
sed 's/columns: 3/colums: 3/' "$root/configs/sites/3x2-bezels.yaml" >"$folder/wrong.yaml"
expect "an error is told with its line" 2 "wrong.yaml:5: key 'colums' is unknown; did you mean 'columns'?" \
    check "$folder/wrong.yaml"
expect "no site" 2 "name a site" check
expect "two sites" 2 "'2x2' is a second one after 'desktop'" check desktop 2x2
expect "a site that is not there" 2 "no-such-site" check no-such-site
expect "a mistyped option" 2 "--corners" check 2x2 --corner

expect "a drawing" 0 "is good" check curved-5x1 --draw "$folder/curve.svg"
python3 -c 'import sys, xml.dom.minidom
svg = xml.dom.minidom.parse(sys.argv[1]).documentElement
texts = [t.firstChild.data for t in svg.getElementsByTagName("text") if t.firstChild]
for tile in ["c%dr0" % i for i in range(5)]:
    assert texts.count(tile) >= 1, tile
assert texts.count("eye") == 3 and "1000 mm" in texts and texts.count("11.66") == 4, texts
for p in svg.getElementsByTagName("text"):
    assert 0 <= float(p.getAttribute("x")) <= 1240 and 0 <= float(p.getAttribute("y")), p.toxml()
    assert float(p.getAttribute("y")) <= float(svg.getAttribute("height")), p.toxml()
' "$folder/curve.svg" >"$folder/python.txt" 2>&1
verdict "the drawing is XML with tiles, eye, gaps and scale on its paper" $? <"$folder/python.txt"
expect "a drawing that is no SVG" 2 "name it FILE.svg" check 2x2 --draw "$folder/wall.png"
expect "a drawing that cannot be written" 5 "nowhere" check 2x2 --draw "$folder/nowhere/wall.svg"
if command -v rsvg-convert >/dev/null; then
    rsvg-convert "$folder/curve.svg" -o "$folder/curve.png" 2>"$folder/python.txt"
    verdict "the drawing can be drawn" $? <"$folder/python.txt"
else
    number=$((number + 1))
    echo "ok $number # SKIP rsvg-convert is not installed"
fi
finish
