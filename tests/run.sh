#!/bin/bash
# Runs the tests and counts them one by one.
#   tests/run.sh TREE [ONLY]      TREE: build tree, out/release; ONLY: parts of "kind/name", any of which will do
# Every tests/<kind>/test_*.c is a cmocka program, every tests/{cli,mpi}/*.sh a script; all speak TAP. Programs and
# scripts find the binary in $GAZEWALL and a folder of their own, removed afterwards, in $GW_TEST_FOLDER.
# Files run side by side, one for each processor: most keep one busy, and assert nothing about time. Those of kind mpi, whose
# ranks take all processors and have deadlines, run alone.
# The last line is "N passed, N failed", with ", N skipped" when some were; exit code 1 if any failed or none ran.
set -u
cd "$(dirname "$0")/.." || exit 1

tree=$1
only=${2:-}
logs=$tree/test-logs
scratch=$(mktemp -d "${TMPDIR:-/tmp}/gazewall-test.XXXXXX") || exit 1
end_children() {
    local children
    children=$(jobs -p)
    # shellcheck disable=SC2086
    [ -z "$children" ] || kill -TERM $children 2>/dev/null
}
stop() {
    end_children
    rm -rf "$scratch"
}
trap stop EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

GAZEWALL=$(cd "$tree" && pwd)/gazewall
export GAZEWALL
export CMOCKA_MESSAGE_OUTPUT=tap
# Octrees that the tests keep are theirs alone.
export XDG_CACHE_HOME=$scratch/cache
# Kernels that software GL has translated once serve the next run: most of the time of the tests of kind gpu.
MESA_SHADER_CACHE_DIR=$(cd "$tree" && pwd)/shader-cache
export MESA_SHADER_CACHE_DIR
# The packaged GL and MPI libraries leak at exit; leaks of our own are looked for in the tests that use neither.
export UBSAN_OPTIONS="${UBSAN_OPTIONS:-print_stacktrace=1:halt_on_error=1}"
export TSAN_OPTIONS="${TSAN_OPTIONS:-allocator_may_return_null=1:halt_on_error=1}"

# What every test is started by, valgrind and its options, say.
read -ra under <<<"${GW_TEST_UNDER:-}"

mkdir -p "$logs"
rm -f "$logs"/*.log
# A line "passed failed skipped" for each file.
counts=$scratch/counts
: >"$counts"

# Seconds after which a file of this kind counts as hanging. Software GL on a busy machine is slow.
limit_of() {
    case $1 in
    unit) echo "${GW_TEST_SECONDS:-120}" ;;
    gpu) echo 600 ;;
    *) echo 1200 ;;
    esac
}

# Whether kind/name is asked for.
wanted() {
    local part
    [ -n "$only" ] || return 0
    for part in $only; do
        case $1 in *"$part"*) return 0 ;; esac
    done
    return 1
}

# Counts the TAP lines of a log: prints "passed failed skipped".
count() {
    awk '
        /^1\.\.[0-9]+/ { split($0, part, "."); plan += part[3] + 0; planned = 1; if (tolower($0) ~ /# *skip/) skip++ }
        /^(not )?ok([ \t]|$)/ {
            seen++
            if (tolower($0) ~ /# *skip/) skip++
            else if ($1 == "ok") pass++
            else fail++
        }
        END {
            if (planned && seen < plan) fail += plan - seen
            print pass + 0, fail + 0, skip + 0
        }' "$1"
}

run_file() {
    local kind=$1 name=$2
    shift 2
    wanted "$kind/$name" || return
    local log=$logs/$kind-$name.log leaks=0 start code p f s
    [ "$kind" != unit ] || leaks=1
    mkdir -p "$scratch/$kind-$name"
    start=$(date +%s.%N)
    GW_TEST_FOLDER=$scratch/$kind-$name ASAN_OPTIONS=${ASAN_OPTIONS:-detect_leaks=$leaks:allocator_may_return_null=1} \
        timeout -k 10 "$(limit_of "$kind")" "${under[@]}" "$@" >"$log" 2>&1 </dev/null &
    wait $!
    code=$?
    rm -rf "${scratch:?}/$kind-$name"
    read -r p f s < <(count "$log" || echo 0 0 0) # no log, no test
    # An exit code without a failed line is a crash, a leak or a time-out; no line at all is no test.
    local why=
    if [ "$code" -eq 124 ] || [ "$code" -eq 137 ]; then
        f=$((f > 0 ? f : 1)) why=" (stopped after $(limit_of "$kind") s)"
    elif [ "$code" -ne 0 ] && [ "$f" -eq 0 ]; then
        f=1 why=" (exit code $code)"
    elif [ $((p + f + s)) -eq 0 ]; then
        f=1 why=" (no test in it)"
    fi
    echo "$p $f $s" >>"$counts"
    awk -v name="$kind/$name" -v p="$p" -v f="$f" -v s="$s" -v why="$why" -v a="$start" -v b="$(date +%s.%N)" 'BEGIN {
        printf "%-44s %4d passed", name, p
        if (f) printf ", %d failed%s", f, why
        if (s) printf ", %d skipped", s
        printf "  (%.1f s)\n", b - a
    }'
    if [ "$f" -gt 0 ]; then
        echo "---- $log"
        tail -n 200 "$log"
        echo "----"
    elif [ "$s" -gt 0 ]; then
        grep -iE '# *skip' "$log" | sed 's/^/    /'
    fi
}

# The same in the background, with its lines printed together when it ends; $slots at once.
slots=$(nproc)
started=0
run_beside() {
    local lines=$scratch/$1-$2.lines
    wanted "$1/$2" || return
    started=$((started + 1))
    while [ "$(jobs -pr | wc -l)" -ge "$slots" ]; do wait -n; done
    (
        trap - EXIT
        trap 'end_children; exit 143' TERM
        run_file "$@" >"$lines"
        cat "$lines"
    ) &
}

# Fast kinds first.
for kind in unit gpu hard oracle; do
    for source in tests/"$kind"/test_*.c; do
        [ -e "$source" ] || continue
        name=$(basename "$source" .c)
        run_beside $kind "$name" "$tree/tests/$kind/$name"
    done
done
for script in tests/cli/*.sh; do
    run_beside cli "$(basename "$script" .sh)" bash "$script"
done
wait
# One that left no counts has failed.
lost=$((started - $(wc -l <"$counts")))
for script in tests/mpi/*.sh; do
    run_file mpi "$(basename "$script" .sh)" bash "$script"
done

read -r passed failed skipped < <(awk -v lost=$lost '{ p += $1; f += $2; s += $3 } END { print p + 0, f + lost, s + 0 }' "$counts")
[ -s "$counts" ] || echo "no test matches '$only'"
if [ "$skipped" -gt 0 ]; then
    echo "$passed passed, $failed failed, $skipped skipped"
else
    echo "$passed passed, $failed failed"
fi
[ "$failed" -eq 0 ] && [ "$passed" -gt 0 ]
