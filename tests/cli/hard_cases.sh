#!/bin/bash
# The catalogue of hard cases: every test that it names exists, every case of its sources has a row, every family has a naive
# variant that fails; damage is found.
# shellcheck source=tests/support/tap.sh
. "$(dirname "$0")/../support/tap.sh"
cd "$(dirname "$0")/../.." || exit 1
catalogue=tests/hard/catalogue.tsv

is "the catalogue is whole" "$(tests/hard/catalogue.sh check)" ""
tests/hard/catalogue.sh markdown >"$folder/hard-cases.md"
same_file "docs/hard-cases.md is made from it (make docs)" docs/hard-cases.md "$folder/hard-cases.md"

damaged() { # NAME SED-COMMAND TEXT
    sed "$2" $catalogue >"$folder/damaged.tsv"
    has "$1" "$(tests/hard/catalogue.sh check "$folder/damaged.tsv")" "$3"
}
damaged "a test that does not exist is found" 's/::bumps_hold/::bumps_held/' "there is no test hard/test_watertight::bumps_held"
damaged "a case without a row is found" '/^runaway-vertex/d' "render:25: this case"
damaged "a family without a naive variant is found" '/\tloops\t/s/\t[^\t]*\t\([^\t]*\)$/\t-\t\1/' "family loops: no naive variant"
damaged "a missing field is found" '2s/\t[^\t]*$//' "9 fields"
finish
