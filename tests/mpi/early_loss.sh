#!/bin/bash
# What is killed or stopped before the first frame ends the run by name, and nothing stays: no process, no shared memory,
# no folder of Open MPI's, not even an empty one.
# shellcheck source=tests/support/tap.sh
. "$(dirname "$0")/../support/tap.sh"
cd "$folder" || exit 1

wait_for_line() { # FILE PATTERN
    local turn
    for turn in $(seq 1200); do
        grep -q "$2" "$1" && return
        sleep 0.05
    done
    echo "# '$2' did not come into $1 in $((turn / 20)) s"
}

# begin NAME LINE WHOM SIGNAL ARGUMENT...: sends the signal to mpirun or a rank as soon as the line is in the log. The scene
# is big enough that frame 1 is far away then.
begin() {
    local name=$1 line=$2 whom=$3 signal=$4 victim first
    shift 4
    mkdir "$name-sessions"
    TMPDIR=$folder/$name-sessions timeout 300 "$program" sim --cache none --tiles 3x1 --size 96x32 --set octree_depth=11 --log debug "$@" --out "$name" \
        >"$name.out" 2>"$name.log" &
    launcher=$!
    wait_for_line "$name.log" "$line"
    first=$(sed -n 's/.*rank . (tile [^)]*) is process \([0-9]*\)$/\1/p' "$name.log" | head -1)
    job=$(tr '\0' '\n' <"/proc/$first/environ" | sed -n 's/^OMPI_MCA_ess_base_jobid=//p')
    if [ "$whom" = mpirun ]; then
        victim=$(pgrep -f -- "^mpirun .*--out $name\$")
    else
        victim=$(sed -n "s/.*rank $whom (tile [^)]*) is process \([0-9]*\)\$/\1/p" "$name.log")
    fi
    kill "-$signal" "$victim"
}

# finish_run NAME PROCESS: waits for its end; what is to be seen then
finish_run() {
    local name=$1 victim
    wait "$2"
    is "$name: exit code" $? 4
    is "$name: no frame was drawn" "$(find "$name" -name 'wall*.png' 2>/dev/null | wc -l)" 0
    is "$name: no process is left" "$(pgrep -f -- "--out $name\$" | wc -l)" 0
    is "$name: nothing of Open MPI's is left" "$(ls "$name-sessions")" ""
    is "$name: no shared memory of MPI's is left" "${job:-no job}$(find /dev/shm -name "vader_segment.*.$(printf %x "$job").*")" "$job"
    while read -r victim; do
        is "$name: no segment of $victim" "$(find /dev/shm -name "gazewall-$victim-*")" ""
    done < <(sed -n 's/.*is process \([0-9]*\)$/\1/p' "$name.log")
}

run() {
    begin "$@"
    finish_run "$1" $launcher
}

# Meanwhile one waits for a sign of life.
begin stopped "rank 1 (tile" 1 STOP --load-deadline 14
stopped=$launcher stopped_job=$job
run mpirun-at-once "rank 0 (tile" mpirun KILL
run mpirun-later "read in" mpirun KILL
has "mpirun: it is told" "$(cat mpirun-later.log)" "killed by signal 9"
run first-at-once "rank 0 (tile" 0 KILL
has "rank 0: it is told by name" "$(cat first-at-once.log)" "rank 0 (tile c0r0, process"
run first-later "read in" 0 KILL
job=$stopped_job
finish_run stopped $stopped
has "a stopped rank: it is told by name, alone" "$(tail -1 stopped.log | grep -v 'rank [02]')" "rank 1 (tile c1r0, process"
has "a stopped rank: and before that" "$(cat stopped.log)" "gives no sign of life since 10 s"
finish
