#!/bin/bash
# The gate alone at 35 tiles, frame after frame: memory, descriptors and shared segments of all processes stay as they were.
# GW_SOAK_FRAMES frames: 8,000 here, 200,000 by `make soak`.
# shellcheck source=tests/support/tap.sh
. "$(dirname "$0")/../support/tap.sh"
cd "$folder" || exit 1
frames=${GW_SOAK_FRAMES:-8000}

# One line per process of the run: number, resident KiB, descriptors.
sample() {
    local process
    for process in $(pgrep -f -- "--report soak-$$.json"); do
        awk -v process="$process" -v files="$(find "/proc/$process/fd" -mindepth 1 2>/dev/null | wc -l)" \
            '/^VmRSS/ { print process, $2, files }' "/proc/$process/status" 2>/dev/null
    done
}

segments() {
    find /dev/shm -name 'gazewall-*' -user "$(id -u)" 2>/dev/null | wc -l
}

timeout 600 "$program" sim --tiles 7x5 --gate-only --live --frames "$frames" --quiet --report "soak-$$.json" >soak.out 2>soak.log &
launcher=$!
for _ in $(seq 600); do # until every rank waits at the gate: they have the launcher's line, their bell and MPI open
    [ "$(sample | awk '$3 > 5' | wc -l)" -ge 36 ] && break
    sleep 0.1
done
sleep 1
sample >first
segments >first-segments
cp first last
while kill -0 $launcher 2>/dev/null; do
    sample >now
    # The last one for which all were there.
    [ "$(wc -l <now)" -eq "$(wc -l <first)" ] && cp now last && segments >last-segments
    sleep 0.5
done
wait $launcher
is "exit code" $? 0
is "all frames went through" "$(json "soak-$$.json" '["frames"]')" "$frames"
is "nobody was lost" "$(json "soak-$$.json" "['tiles'].__len__() - sum(t['lost'] == 0 for t in d['tiles'])")" 0
echo "# gate: $(json "soak-$$.json" '["frame_ms"]'), processor ms a frame of a waiting rank: $(json "soak-$$.json" "['tiles'][1]['processor_ms'] / $frames")"
is "35 ranks were looked at" "$(($(wc -l <first) >= 35))" 1
join <(sort first) <(sort last) | awk '{ print $4 - $2 }' | sort -rn >grown
is "resident memory grows nowhere" "$(awk 'NR > 1 && $1 > 1024' grown | wc -l)" 0
# Rank 0 keeps state and time of every frame of a run with an end, less than half a KiB each.
is "but for rank 0's frames" "$(awk -v most=$((1024 + frames / 2)) 'NR == 1 { print ($1 <= most) }' grown)" 1
is "descriptors grow nowhere" "$(join <(sort first) <(sort last) | awk '$5 > $3' | wc -l)" 0
is "shared segments do not grow" "$(($(cat last-segments) <= $(cat first-segments)))" 1
finish
