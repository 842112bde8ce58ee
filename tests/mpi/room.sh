#!/bin/bash
# Trackers of a site file: a device in millimetres with z up, a head behind its sensor, a gaze from the head alone, a
# joystick; a unit that cannot be; and a VRPN device that is moved in the room while frames are drawn.
# shellcheck source=tests/support/tap.sh
. "$(dirname "$0")/../support/tap.sh"
make_scene "$folder/sheet.obj"
cd "$folder" || exit 1
cat >wall.yaml <<END
version: 1
eye: [0, 1600, 2000]
grid: {columns: 1, rows: 1, centre: [0, 1500, 0], tile: {width: 1600, height: 900, pixels: [32, 18]}}
trackers:
  - source: Tracker0@h
    unit: mm
    axes: z-up
    shift: [0, 100, 0]
    viewers: [{head: 3, eye_offset: [0, -80, -60], gaze: head}]
    navigation: {forward: 1, turn: 0, reset: 2}
END
sed 's/unit: mm/unit: m/' wall.yaml >metres.yaml
{ # a head that stands still for 1.2 s; the stick is pushed ahead from 0.05 s on and let go at 0.7 s, then the button
    echo arrival_s,sender,kind,sensor,x,y,z,qx,qy,qz,qw,value
    for i in $(seq 0 60); do
        printf '%d.%03d,Tracker0,pose,3,200,-2000,1700,0,0,0,1,\n' $((i / 50)) $((i % 50 * 20))
        [ "$i" = 2 ] && echo 0.05,Tracker0,analog,1,,,,,,,,0.8
        [ "$i" = 34 ] && echo 0.69,Tracker0,analog,1,,,,,,,,0.01
        [ "$i" = 42 ] && echo 0.85,Tracker0,button,2,,,,,,,,1
    done
} >walk.csv
sim() { # SITE ARGUMENT...
    timeout 300 "$program" sim --site "$1" --scene sheet.obj --set octree_depth=4 --track walk.csv --step 0.3 \
        --report report.json "${@:2}" 2>&1
}
sim wall.yaml --frames 4 --save-states states.json >log.txt
is "the site's device is followed" $? 0
is "it is not suspected" "$(json report.json "['tracking']['suspected']")" "[]"
state() { # LINE FIELD: of frame LINE - 2
    sed -n "$1p" states.json | python3 -c 'import json, sys; print(json.load(sys.stdin)[sys.argv[1]])' "$2"
}
is "the eye is where sensor, room and offset put it" "$(state 2 eye)" "[200.0, 1720.0, 1940.0]"
has "the gaze is the head's" "$(state 2 gazes)" "'direction': [0.0, 0.0, -1.0]"
has "as wide as that is unsure" "$(state 2 gazes)" "'half_width': 32.0"
is "nobody has flown yet" "$(state 2 stand)" "[0.0, 0.0, 0.0]"
is "the stick flies ahead" "$(echo "$(state 3 stand) $(state 4 stand)" | awk -F'[][, ]+' '{ print ($8 < $4 - 0.5) }')" 1
is "the button leads back" "$(state 5 stand)" "[0.0, 0.0, 0.0]"
has "a unit that cannot be is told" "$(sim metres.yaml --frames 2)" \
    "tracker Tracker0@h: 16 of 16 positions are more than 50 m from the device's origin with a unit of 1000 mm (m); is it mm?"

# --- a live device; its shift is changed in the site file, and the eye glides there
{
    echo arrival_s,sender,kind,sensor,x,y,z,qx,qy,qz,qw
    for i in $(seq 0 60); do printf '%d.%02d,Tracker0,pose,0,0.2,1.7,2,0,0,0,1\n' $((i / 50)) $((i % 50 * 2)); done
} >still.csv
"$program" replay still.csv --serve vrpn:127.0.0.1:0 --loop >play.log &
player=$!
until port=$(sed -n 's/^serving .* port \([0-9]*\)$/\1/p' play.log) && [ -n "$port" ]; do sleep 0.02; done
live() { # SHIFT
    printf 'version: 1\neye: [0, 1600, 2000]\n%s\ntrackers:\n  - {source: "Tracker0@127.0.0.1:%d", shift: [0, %d, 0], viewers: [{head: 0, gaze: none}]}\n' \
        'grid: {columns: 1, rows: 1, centre: [0, 1500, 0], tile: {width: 1600, height: 900, pixels: [32, 18]}}' "$port" "$1"
}
live 0 >live.yaml
timeout 300 "$program" sim --site live.yaml --scene sheet.obj --set octree_depth=4 --live --frames 1000000 --headless \
    --out live --save-states live.states --log info >live.log 2>&1 &
running=$!
eye_is() { # X-MM Y-MM: within 100 s the newest row has that eye
    for ((try = 0; try < 5000; try++)); do
        [ "$(tail -n 2 live/frames.csv 2>/dev/null | head -1 | awk -F, '{ printf "%.0f %.0f", $4, $5 }')" = "$1 $2" ] && return
        sleep 0.02
    done
    return 1
}
eye_is 200 1700
verdict "the device is followed" $? <live.log
live 300 >live.new
mv live.new live.yaml
eye_is 200 2000
verdict "its new place is taken over" $? <live.log
kill -INT $running
wait $running
is "the wall went on" $? 130
kill -INT $player
wait $player
is "and so did the player" $? 130
is "the eye glides there, at no more than 1.2 m/s" "$(python3 - <<'P'
import csv, math
rows = [r for r in csv.DictReader(open("live/frames.csv")) if r["eye_y_mm"]]
at = [(1e3 * float(r["time_s"]), [float(r["eye_%s_mm" % k]) for k in "xyz"]) for r in rows]
worst = max(math.dist(b[1], a[1]) - 1.2 * (b[0] - a[0]) for a, b in zip(at, at[1:]))
between = sum(1 for _, e in at if 1710 < e[1] < 1990)
print(worst < 2 or worst, between > 0 or len(at))
P
)" "True True"
finish
