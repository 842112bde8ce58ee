#!/bin/bash
# A live wall goes on whatever one of its tiles does, and names it: killed, stopped and continued, hanging, slow, or without
# its GL context. What tiles show is what they would have shown undisturbed. Rank 0 lost: no tile shows a frozen frame.
# shellcheck source=tests/support/tap.sh
. "$(dirname "$0")/../support/tap.sh"
make_scene "$folder/sheet.obj"
cd "$folder" || exit 1
wall=(sim --scene sheet.obj --set octree_depth=5 --tiles 3x2 --size 96x64 --log debug)
alone=(--live --restarts 0) # tests/mpi/rejoin.sh has those that come back
frames=250

pid_of() { # LOG RANK
    sed -n "s/.*rank $2 (tile [^)]*) is process \([0-9]*\)\$/\1/p" "$1"
}

# wait_for_text FILE TEXT [COUNT]: so many lines; at most 60 s
wait_for_text() {
    for _ in $(seq 1200); do
        [ "$(grep -cF -- "$2" "$1" 2>/dev/null)" -ge "${3:-1}" ] && return
        sleep 0.05
    done
    echo "# '$2' did not come in $1"
}

tile() { # REPORT NUMBER KEY
    json "$1" "['tiles'][$2]['$3']"
}

# survivors REPORT NUMBER...: how many of those tiles lost more than one frame in twenty
survivors() {
    local report=$1 which behind
    shift
    which=$(IFS=,; echo "$*")
    behind=$(json "$report" " and sum(t['lost'] > 0 or t['presented'] * 20 < $frames * 19 for t in d['tiles'] if t['rank'] in ($which,))")
    [[ $behind =~ ^[0-9]+$ ]] && echo "$behind" || echo 99
}

# A machine that others load makes any tile late now and then, and no gate can mend that: such a run counts for nothing
# and is repeated, at most twice. A gate that lets the survivors wait would fail each time.
until_undisturbed() { # FUNCTION REPORT NUMBER...
    local run=$1 attempt
    shift
    for attempt in 1 2 3; do
        stopped=1
        $run
        behind=$(($(survivors "$@") + (stopped == 0)))
        [ "$behind" -eq 0 ] && break
        echo "# run $attempt counts for nothing: $behind tiles were late before they should be"
    done
}

# --- undisturbed, in lock-step: what every frame of every tile looks like
timeout 300 "$program" "${wall[@]}" --frames $frames --out calm --report calm.json >calm.out 2>calm.log
is "lock-step: exit code" $? 0
is "lock-step: every tile showed every frame" "$(json calm.json "['tiles'].__len__() + 10 * sum(t['presented'] == $frames for t in d['tiles'])")" 66
is "lock-step: swap skew is measured for every frame" "$(json calm.json '["swap_skew_ms"]["frames"]')" $frames

# --- live: one is killed, one stopped and continued, one slow
live() {
    rm -rf live live.json
    timeout 300 "$program" "${wall[@]}" --frames $frames --out live --report live.json "${alone[@]}" --frame-deadline 0.1 \
        --death-deadline 30 --tile-fault kill:1@10 --tile-fault stop:2@15 --tile-fault slow:4@5 >live.out 2>live.log &
    launcher=$!
    # One that was late before is not there for the frame in which it would have been stopped.
    until grep -q "tile c2r0 (rank 2) is late since frame" live.log || ! kill -0 $launcher 2>/dev/null; do sleep 0.05; done
    stopped=$(grep -c "tile c2r0 (rank 2) is late since frame 15: its process is stopped" live.log)
    sleep 0.3
    kill -CONT "$(pid_of live.log 2)"
    wait $launcher
    code=$?
}
until_undisturbed live live.json 0 3 5
is "live: exit code" "$code" 1
is "live: all frames were drawn" "$(json live.json '["frames"]')" $frames
is "live: the others show 95 % of the frames" "$behind" 0
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
read -r different shown < <(differing 'tile-*-[0-9]*.png' live calm)
is "live: what tiles show is what they show undisturbed ($shown pictures)" "$different $((shown > 3 * frames))" "0 1"
is "live: incomplete walls say so" "$(find live -name 'wall-[0-9]*-incomplete.png' | wc -l)" \
    "$(tail -n +2 live/frames.csv | awk -F, '$(NF - 2) + $(NF - 1) + $NF > 0' | wc -l)"

# --- live: one hangs, one loses its context, one is stopped for good
faults() {
    timeout 300 "$program" "${wall[@]}" --frames $frames --report faults.json "${alone[@]}" --frame-deadline 0.5 --death-deadline 1 \
        --tile-fault hang:2@20 --tile-fault context:3@25 --tile-fault stop:5@30 >faults.out 2>faults.log
    code=$?
}
until_undisturbed faults faults.json 0 1 4
is "faults: exit code" "$code" 1
is "faults: all frames were drawn" "$(json faults.json '["frames"]')" $frames
is "faults: the others show 95 % of the frames" "$behind" 0
has "hanging: it is named for what it is" "$(tile faults.json 2 fault)" "it hangs"
has "context: it is named for what it is" "$(tile faults.json 3 fault)" "the GL context was lost"
has "stopped: it is named for what it is" "$(tile faults.json 5 fault)" "its process is stopped"
is "faults: no process is left" "$(pgrep -f -- "--report faults.json" | wc -l)" 0

# --- a tile that was late and is as fast as the others is soon waited for again, also the fifth time
timeout 300 "$program" sim --tiles 4x1 --gate-only --live --restarts 0 --frames 1000000 --frame-deadline 0.5 --death-deadline 120 \
    --report often.json --log debug >often.out 2>often.log &
launcher=$!
wait_for_text often.log "frame "
for turn in 1 2 3 4 5; do
    kill -STOP "$(pid_of often.log 2)"
    wait_for_text often.log "tile c2r0 (rank 2) is late" $turn
    kill -CONT "$(pid_of often.log 2)"
    wait_for_text often.log "tile c2r0 keeps up again" $turn
done
kill -INT $launcher
wait $launcher
is "often late: it keeps up again each time" "$(grep -c "tile c2r0 keeps up again" often.log) $(tile often.json 2 state)" "5 live"

# --- options that contradict each other
expect "a frame deadline without --live" 2 "--frame-deadline goes with --live" sim --scene sheet.obj --frame-deadline 1
expect "a fault that is none" 2 "is not KIND:TILE@FRAME" sim --scene sheet.obj --tile-fault sleep:1@2
finish
