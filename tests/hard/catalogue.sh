#!/bin/bash
# The catalogue of hard cases, tests/hard/catalogue.tsv: one row for each, with the tests that hold it.
#   tests/hard/catalogue.sh check [FILE]     says what is wrong with it; exit code 1 if anything is
#   tests/hard/catalogue.sh markdown         docs/hard-cases.md
#   tests/hard/catalogue.sh files            the test files that it names, kind/name, as tests/run.sh takes them
#   tests/hard/catalogue.sh table LOGS       what the last run said of each case and of its naive variant
# Sources are numbered as in the notes that the cases come from: render 1-40 a survey of renderers, a T1-T17, b H1-H25 and c 1-18
# a course on geometry by graphics hardware (2003).
set -u
cd "$(dirname "$0")/../.." || exit 1
file=tests/hard/catalogue.tsv

rows() {
    tail -n +2 "$file"
}

# A test is kind/file::function, or a whole file of kind cli or mpi.
exists() {
    local place=${1%%::*} function=${1#*::}
    case $1 in
    *::*) grep -qE "(cmocka_unit_test\w*\(|\")$function\b" "tests/$place.c" 2>/dev/null ;;
    *.sh | *.c) [ -e "tests/$1" ] ;;
    *) false ;;
    esac
}

all_sources() {
    local i
    for ((i = 1; i <= 40; i++)); do echo "render:$i"; done
    for ((i = 1; i <= 17; i++)); do echo "a:T$i"; done
    for ((i = 1; i <= 25; i++)); do echo "b:H$i"; done
    for ((i = 1; i <= 18; i++)); do echo "c:$i"; done
}

faults() {
    rows | awk -F '\t' 'NF != 10 { print $1 ": " NF " fields, not 10" } seen[$1]++ { print $1 ": a second row of this name" }'
    local name tests naive status test
    while IFS=$'\t' read -r name _ _ _ _ _ _ tests naive status; do
        case $status in
        tested) [ "$tests" != - ] || echo "$name: tested, but no test is named" ;;
        "waiting for "*) ;;
        *) echo "$name: status '$status' is neither 'tested' nor 'waiting for ...'" ;;
        esac
        for test in $tests $naive; do
            [ "$test" = - ] || exists "$test" || echo "$name: there is no test $test"
        done
    done < <(rows)
    comm -23 <(all_sources | sort) <(rows | cut -f 3 | tr ' ' '\n' | sort -u) | sed 's/$/: this case of the sources has no row/'
    comm -13 <(all_sources | sort) <(rows | cut -f 3 | tr ' ' '\n' | sort -u) | sed 's/$/: there is no such source/'
    rows | awk -F '\t' '$10 == "tested" { tested[$2] = 1; if ($9 != "-") naive[$2] = 1 }
        END { for (f in tested) if (!naive[f] && f != "input") print "family " f ": no naive variant is seen to fail" }'
}

markdown() {
    cat <<'TEXT'
# Hard cases

Made from `tests/hard/catalogue.tsv` by `make docs`; do not edit. `make hard` runs every test that is named here and prints what it
said of each case and of the naive way, which must fail. What is guaranteed, and why, is in [numerics](numerics.md).
TEXT
    rows | awk -F '\t' '
        $2 != family { family = $2; print "\n## " family "\n\n| case | input | must hold | why the naive way fails | oracle | tests | sources |\n|---|---|---|---|---|---|---|" }
        {
            gsub(/ /, ", ", $3); gsub(/::/, " ", $8); tests = $8
            n = split(tests, words, " "); tests = ""
            for (i = 1; i <= n; i++) tests = tests (words[i] ~ /\// ? (i > 1 ? "; " : "") "`" words[i] "`" : " " words[i])
            print "| " $1 " | " $4 " | " $5 " | " $6 " | " $7 " | " ($10 == "tested" ? tests : $10) " | " $3 " |"
        }'
}

files() {
    rows | cut -f 8,9 | tr -s '\t ' '\n' | sed 's/::.*//; s/\.sh$//; s/\.c$//' | grep / | sort -u
}

# What a test said in the logs of the last run: ok, FAILED, skipped, or not run.
said() {
    local place=${1%%::*} function=${1#*::} log
    place=${place%.sh} place=${place%.c}
    log=$2/${place/\//-}.log
    [ -e "$log" ] || { echo "not run"; return; }
    if [[ $1 == *::* ]]; then
        grep -qiE "^ok [0-9]+ - $function # *skip" "$log" && { echo skipped; return; }
        grep -qE "^ok [0-9]+ - $function\b" "$log" && { echo ok; return; }
        echo FAILED
    elif grep -q '^not ok' "$log"; then
        echo FAILED
    else
        echo ok
    fi
}

worst_of() {
    local worst=ok word
    for test in $1; do
        [ "$test" != - ] || { echo -; return; }
        word=$(said "$test" "$2")
        case $word in
        FAILED) worst=FAILED ;;
        "not run") [ "$worst" = FAILED ] || worst="not run" ;;
        skipped) [ "$worst" != ok ] || worst=skipped ;;
        esac
    done
    echo "$worst"
}

table() {
    local name family tests naive status shipped
    printf '%-14s %-26s %-10s %s\n' family case shipped 'naive way fails'
    while IFS=$'\t' read -r name family _ _ _ _ _ tests naive status; do
        shipped=$status
        naive=$(worst_of "$naive" "$1")
        [ "$status" != tested ] || shipped=$(worst_of "$tests" "$1")
        [ "$naive" != ok ] || naive="as it should"
        printf '%-14s %-26s %-10s %s\n' "$family" "$name" "$shipped" "$naive"
    done < <(rows)
}

case ${1:-} in
check)
    file=${2:-$file}
    found=$(faults)
    [ -z "$found" ] || { printf '%s\n' "$found"; exit 1; }
    ;;
markdown | files) "$1" ;;
table) table "$2" ;;
*)
    sed -n '2,6s/^# *//p' "$0"
    exit 2
    ;;
esac
