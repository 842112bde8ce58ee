#!/bin/bash
# A live wall goes on whatever one of its tiles does, and names it: killed, stopped and continued, hanging, slow, or without
# its GL context. What tiles show is what they would have shown undisturbed. Rank 0 lost: no tile shows a frozen frame.
# shellcheck source=tests/support/tap.sh
. "$(dirname "$0")/../support/tap.sh"
make_scene "$folder/sheet.obj"
cd "$folder" || exit 1
wall=(sim --scene sheet.obj --set octree_depth=5 --tiles 3x2 --size 96x64 --log debug)
alone=(--live --restarts 0) # tests/mpi/rejoin.sh has those that come back
frames=400

pid_of() { # LOG RANK
    sed -n "s/.*rank $2 (tile [^)]*) is process \([0-9]*\)\$/\1/p" "$1"
}

# wait_for_text FILE TEXT: at most 60 s
wait_for_text() {
    for _ in $(seq 1200); do
        grep -qF -- "$2" "$1" 2>/dev/null && return
        sleep 0.05
    done
    echo "# '$2' did not come in $1"
}

tile() { # REPORT NUMBER KEY
    json "$1" "['tiles'][$2]['$3']"
}

# survivors NAME REPORT NUMBER...: those tiles showed the wall's frames; a loaded machine may make one late now and then.
survivors() {
    local name=$1 report=$2 which shown
    shift 2
    for which in "$@"; do
        shown=$(tile "$report" "$which" presented)
        is "$name: tile $which goes on ($shown of $frames frames)" \
            "$(tile "$report" "$which" lost) $((shown * 2 >= frames))" "0 1"
    done
}

# --- undisturbed, in lock-step: what every frame of every tile looks like
timeout 300 "$program" "${wall[@]}" --frames $frames --out calm --report calm.json >calm.out 2>calm.log
is "lock-step: exit code" $? 0
is "lock-step: every tile showed every frame" "$(json calm.json "['tiles'].__len__() + 10 * sum(t['presented'] == $frames for t in d['tiles'])")" 66
is "lock-step: swap skew is measured for every frame" "$(json calm.json '["swap_skew_ms"]["frames"]')" $frames

# --- live: one is killed, one stopped and continued, one slow
timeout 300 "$program" "${wall[@]}" --frames $frames --out live --report live.json "${alone[@]}" --frame-deadline 0.1 \
    --death-deadline 30 --tile-fault kill:1@10 --tile-fault stop:2@15 --tile-fault slow:4@5 >live.out 2>live.log &
launcher=$!
wait_for_text live.log "tile c2r0 (rank 2) is late"
sleep 0.3
kill -CONT "$(pid_of live.log 2)"
wait $launcher
is "live: exit code" $? 1
is "live: all frames were drawn" "$(json live.json '["frames"]')" $frames
survivors "live" live.json 0 3 5
is "killed: state" "$(tile live.json 1 state) $(tile live.json 1 lost)" "lost 1"
has "killed: it is named for what it is" "$(tile live.json 1 fault)" "process"
has "killed: the log names it" "$(cat live.log)" "tile c1r0 (rank 1) is lost since frame"
has "stopped: the log names it" "$(cat live.log)" "tile c2r0 (rank 2) is late since frame 15: its process is stopped"
is "stopped, then continued: it is not lost" "$(tile live.json 2 lost)" 0
is "stopped, then continued: it skipped frames" "$(($(tile live.json 2 skipped) > 3))" 1
is "stopped, then continued: it shows new frames again" "$(($(tile live.json 2 presented) > 16))" 1
is "slow: state" "$(tile live.json 4 state) $(tile live.json 4 lost)" "late 0"
has "slow: it is named for what it is" "$(cat live.log)" "tile c1r1 (rank 4) is late since frame 5: it is slow"
is "slow: the wall does not wait for it again and again" "$(($(tile live.json 4 late) * 4 < $(tile live.json 4 skipped)))" 1
has "live: the summary says that not all lasted" "$(cat live.out)" "NOT ALL OF THEM TO THE END"
different=0
shown=0
for picture in live/tile-*-[0-9]*.png; do
    shown=$((shown + 1))
    cmp -s "$picture" "calm/$(basename "$picture")" || different=$((different + 1))
done
is "live: what tiles show is what they show undisturbed ($shown pictures)" "$different $((shown > 3 * frames))" "0 1"
is "live: incomplete walls say so" "$(find live -name 'wall-[0-9]*-incomplete.png' | wc -l)" \
    "$(tail -n +2 live/frames.csv | awk -F, '$(NF - 2) + $(NF - 1) + $NF > 0' | wc -l)"

# --- live: one hangs, one loses its context, one is stopped for good
timeout 300 "$program" "${wall[@]}" --frames $frames --report faults.json "${alone[@]}" --frame-deadline 0.5 --death-deadline 1 \
    --tile-fault hang:2@20 --tile-fault context:3@25 --tile-fault stop:5@30 >faults.out 2>faults.log
is "faults: exit code" $? 1
is "faults: all frames were drawn" "$(json faults.json '["frames"]')" $frames
survivors "faults" faults.json 0 1 4
has "hanging: it is named for what it is" "$(tile faults.json 2 fault)" "it hangs"
has "context: it is named for what it is" "$(tile faults.json 3 fault)" "the GL context was lost"
has "stopped: it is named for what it is" "$(tile faults.json 5 fault)" "its process is stopped"
is "faults: no process is left" "$(pgrep -f -- "--report faults.json" | wc -l)" 0

# --- options that contradict each other
expect "a frame deadline without --live" 2 "--frame-deadline goes with --live" sim --scene sheet.obj --frame-deadline 1
expect "a fault that is none" 2 "is not KIND:TILE@FRAME" sim --scene sheet.obj --tile-fault sleep:1@2
finish
