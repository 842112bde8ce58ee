#!/bin/bash
# Runs the fuzzers that `make fuzz` built, each for some seconds, from its seeds in tests/fuzz/seeds if it has some. What
# breaks one stays in the folder of its program.
#   tests/fuzz/run.sh FOLDER SECONDS [NAME]
set -u
cd "$(dirname "$0")/../.." || exit 1
folder=$1 seconds=$2 found=0
for program in "$folder"/fuzz_${3:-*}; do
    case $program in *.o | *.d) continue ;; esac
    name=${program##*/fuzz_}
    mkdir -p "$folder/corpus/$name"
    seeds=()
    [ -d "tests/fuzz/seeds/$name" ] && seeds=("tests/fuzz/seeds/$name")
    if "$program" -max_total_time="$seconds" -artifact_prefix="$folder/$name-" "$folder/corpus/$name" "${seeds[@]}" \
        >"$folder/$name.log" 2>&1; then
        printf '%-20s %s\n' "$name" "$(grep -h '^Done' "$folder/$name.log")"
    else
        printf '%-20s BROKEN: %s; see %s\n' "$name" "$(grep -h -m1 '^SUMMARY' "$folder/$name.log")" "$folder/$name.log"
        found=1
    fi
done
exit $found
