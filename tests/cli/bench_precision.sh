#!/bin/bash
# The precision ladder, quick: what ships never fails where it promises not to, and the usual test does.
# shellcheck source=tests/support/tap.sh
. "$(dirname "$0")/../support/tap.sh"

"$program" bench precision --quick --quiet --out "$folder" >"$folder/said" 2>&1
is "bench precision runs, and what ships does not fail" $? 0
failures() { # FAMILY RUNG
    awk -F , -v family="$1" -v rung="$2" '$1 == family && $2 == rung { print $4 }' "$folder/precision.csv"
}
for family in vertices edges snapped outside; do
    is "$family: shipped and ordered fail for no ray" "$(failures $family shipped) $(failures $family ordered)" "0 0"
done
[ "$(failures edges fast)" -gt 0 ]
verdict "Moeller and Trumbore's test fails" $? <"$folder/precision.csv"
exists "the report is written" "$folder/precision.json"
finish
