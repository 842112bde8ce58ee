#!/bin/bash
# An interrupted wall leaves nothing: no process, no shared memory, no half-written file; whatever moment it was.
# shellcheck source=tests/support/tap.sh
. "$(dirname "$0")/../support/tap.sh"
make_scene "$folder/sheet.obj"
cd "$folder" || exit 1

segments() {
    find /dev/shm -name 'gazewall-*' -user "$(id -u)" 2>/dev/null | sort
}

# Waits until no process of the run is left, at most 10 s; prints how many there are then.
left() {
    for _ in $(seq 100); do
        pgrep -f -- "--out $1\$" >/dev/null || break
        sleep 0.1
    done
    pgrep -f -- "--out $1\$" | wc -l
}

# run SIGNAL SECONDS CODE [OPTION...]
run() {
    local name=interrupted-$1-$2-$#-$$
    local before
    before=$(segments)
    "$program" sim --scene sheet.obj --set octree_depth=5 --tiles 2x1 --size 96x32 --frames 100000 "${@:4}" --quiet --save-states "$name.states" --report "$name.json" --out "$name" >"$name.out" 2>"$name.log" &
    local launcher=$!
    if [ "$2" = frames ]; then
        for _ in $(seq 600); do
            [ -e "$name/wall-0003.png" ] && break
            sleep 0.1
        done
    else
        sleep "$2"
    fi
    kill "-$1" $launcher
    wait $launcher 2>/dev/null
    is "SIG$1 after $2: exit code" $? "$3"
    is "SIG$1 after $2: no process is left" "$(left "$name")" 0
    is "SIG$1 after $2: no shared memory is left" "$(segments | comm -13 <(echo "$before") - | wc -l)" 0
    if [ "$2 $1" = "frames INT" ] || [ "$2 $1" = "frames TERM" ]; then
        local frames
        frames=$(json "$name.json" '["frames"]')
        is "SIG$1 after $2: the report says so" "$(json "$name.json" '["ended"]')" interrupted
        is "SIG$1 after $2: a state for each frame" "$(wc -l <"$name.states")" $((frames + 1))
        is "SIG$1 after $2: a row for each frame" "$(wc -l <"$name/frames.csv")" $((frames + 1))
        is "SIG$1 after $2: a picture for each frame" "$(find "$name" -name 'wall-[0-9]*.png' | wc -l)" "$frames"
    fi
    is "SIG$1 after $2: only whole files" "$(find "$name" -type f ! -name '*.png' ! -name '*.json' ! -name frames.csv 2>/dev/null)" ""
}

run INT 0.2 130
run INT 0.7 130
run INT frames 130
run TERM 0.5 143
run TERM frames 143
run KILL 0.3 137
run KILL frames 137

# --- while kernels are made in the background: those of a gaze that is lost in frame 3
python3 - "interrupted-INT-frames-3-$$.states" >lost.states <<'END'
import json, sys
lines = open(sys.argv[1]).read().splitlines()
print(lines[0])
for number in range(2000):
    state = json.loads(lines[1 + min(number, 3)])
    print(json.dumps({**state, "frame": number, "gazes": state["gazes"] if number < 3 else []}))
END
MESA_SHADER_CACHE_DISABLE=true run INT frames 130 --frames 2000 --states lost.states --kernels background --cache none
making=$(json "interrupted-INT-frames-11-$$.json" '["effects"]["variants"]')
has "while kernels are made: in the background" "$making" "'making': 'background'"
is "while kernels are made: others drew" "${making//*\'stand_in_frames\': 0*/none}" "$making"

# --- a segment that a killed run left is swept by the next
dead=$(bash -c 'echo $$')
: >"/dev/shm/gazewall-$dead-0123456789abcdef"
: >"/dev/shm/gazewall-$$-0123456789abcdef"
expect "a run after a crash" 0 "" sim --scene sheet.obj --set octree_depth=5 --tiles 2x1 --size 96x32 --quiet
is "the dead owner's segment is swept" "$(ls "/dev/shm/gazewall-$dead-0123456789abcdef" 2>/dev/null)" ""
exists "the living owner's is not" "/dev/shm/gazewall-$$-0123456789abcdef"
rm -f "/dev/shm/gazewall-$$-0123456789abcdef"

# --- render, too
"$program" render --size 640x480 --quiet --out render.png 2>render.log &
sleep 1
kill -INT $!
wait $! 2>/dev/null
is "render: exit code" $? 130
is "render: only whole files" "$(find . -maxdepth 1 -name 'render.png*')" ""
finish
