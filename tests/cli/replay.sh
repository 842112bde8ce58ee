#!/bin/bash
# gazewall replay: what it says of good tracks, and that bad ones and bad command lines end in one clear sentence.
# shellcheck source=tests/support/tap.sh
. "$(dirname "$0")/../support/tap.sh"
root=$(cd "$(dirname "$0")/../.." && pwd)
demo=$root/configs/tracks/demo.vrpn

size=$(stat -c %s "$demo")
head -c $((size - 5)) "$demo" > "$folder/cut.vrpn"
head -c 24 "$demo" > "$folder/bare.vrpn"
head -c 23 "$demo" > "$folder/short.vrpn"
: > "$folder/empty.vrpn"
{ printf 'vrpn: ver. 08.00'; tail -c +17 "$demo"; } > "$folder/future.vrpn"
{ head -c 40 "$demo"; printf '\177\377\377\377'; tail -c +45 "$demo"; } > "$folder/long.vrpn"
cut -c 1-40 "$root/README.md" > "$folder/text.vrpn"

expect "the demo track" 0 "Demo0 sensor 1 (gaze of viewer 0): 481 poses from 0.000 to 8.000 s, 60.0 Hz" replay demo --info
expect "its file" 0 "0 skipped" replay "$demo"
expect "its device by name" 0 "962 of events" replay "$demo" --sender Demo0
expect "help" 0 "Usage: gazewall replay" replay --help
expect "a table" 0 "" replay "$demo" --csv "$folder/demo.csv"
is "one row per pose" "$(wc -l < "$folder/demo.csv")" 963
is "the table's head" "$(head -1 "$folder/demo.csv" | cut -d, -f1-10)" "arrival_s,sender,kind,sensor,device_s,latency_s,quality,x,y,z"
is "seconds and metres" "$(awk -F, 'NR == 963 { print ($1 == 1000000008 && $10 > 1.5 && $10 < 2) }' "$folder/demo.csv")" 1
expect "a table is a track" 0 "(CSV)" replay "$folder/demo.csv" --info
expect "a part of a track" 0 "60 poses from 2.000 to 2.983 s" replay demo --from 2 --to 3
expect "no track" 2 "name a track" replay --info
expect "two tracks" 2 "one track at a time" replay "$demo" "$demo"
expect "a missing file" 2 "nowhere.vrpn" replay "$folder/nowhere.vrpn"
expect "a folder" 2 "folder" replay "$folder"
expect "an empty file" 2 "byte 0: not a VRPN log" replay "$folder/empty.vrpn"
expect "half a cookie" 2 "byte 0: not a VRPN log" replay "$folder/short.vrpn"
expect "another kind of file" 2 "neither a VRPN log nor CSV" replay "$folder/text.vrpn"
expect "a later major version" 2 "major version 4 to 7" replay "$folder/future.vrpn"
expect "a cut record is told" 0 "byte $((size - 88)), record 964: a payload of 64 bytes was expected, 59 are there" replay "$folder/cut.vrpn"
expect "what is before the cut is used" 0 "(gaze of viewer 0): 480 poses" replay "$folder/cut.vrpn"
expect "a length beyond what a record may have" 2 "there is no event in it" replay "$folder/long.vrpn"
expect "its place" 2 "byte 24, record 1: a payload of 0 to 64000 bytes was expected" replay "$folder/long.vrpn"
expect "a log without events" 2 "there is no event in it" replay "$folder/bare.vrpn"
expect "an unknown device" 2 "senders: Demo0" replay "$demo" --sender Wand
track=$root/configs/tracks/dropouts.vrpn.gz
expect "a drawing and a report" 0 "" replay "$track" --plot "$folder/p.svg" --report "$folder/p.json" --site 3x2-bezels
is "the drawing is XML with both sensors, their gaps and the wall" "$(python3 - "$folder/p.svg" <<'EOF'
import sys, xml.dom.minidom as m
d = m.parse(sys.argv[1])
t = [x.firstChild.data for x in d.getElementsByTagName("text")]
print("Gazes on the wall" in t, "c2r1" in t, sum("Synthetic0: " in x for x in t), sum(r.getAttribute("fill") == "#d9d9d9" for r in d.getElementsByTagName("rect")) > 8)
EOF
)" "True True 2 True"
is "the report tells of gaps, clock and buttons" "$(python3 - "$folder/p.json" <<'EOF'
import json, sys
t = json.load(open(sys.argv[1]))["tracking"]
s = {(x["kind"], x["sensor"]): x for x in t["sensors"]}
h = s["pose", 0]
print(t["damage"], h["gaps"], h["clock_steps"], h["interval_longest_ms"] > 2900, s["button", 0]["presses"], t["counters"]["poses"] == h["events"])
EOF
)" "None 4 1 True 3 True"
# A listener that says its port, then how many frames came.
coproc listener { timeout 30 python3 -c '
import socket
s = socket.socket(socket.AF_INET, socket.SOCK_DGRAM); s.bind(("127.0.0.1", 0)); s.settimeout(20)
print(s.getsockname()[1], flush=True)
n = 0
while n < 60: n += b"6d 2 [0 1.000]" in s.recv(65536)
print(n, flush=True)'; }
exec {heard}<&"${listener[0]}" # bash forgets its own end when the listener is done
read -r port <&"$heard"
expect "played as DTrack frames" 0 "0 unsendable" replay demo --serve "dtrack:127.0.0.1:$port" --to 2 --speed 4
read -r frames <&"$heard"
is "the frames came" "$frames" 60
# Ctrl-C is a good end of what has none.
timeout 60 "$program" replay demo --serve "dtrack:127.0.0.1:$port" --loop --speed 20 >"$folder/loop.log" &
sleep 0.1
looping=$(pgrep -P $! | head -1)
until grep -q serving "$folder/loop.log"; do sleep 0.02; done
kill -INT "$looping"
wait $!
is "a loop that is interrupted" $? 130
has "tells what it served" "$(cat "$folder/loop.log")" "served       DTrack frames to 127.0.0.1 port $port: "

# Tracks of this program by name; units that cannot be; rooms of a site's trackers.
expect "a shipped track by its name" 0 "Synthetic0 sensor 0 (head of viewer 0): 600 poses" replay walking
expect "a misspelt one" 2 "did you mean 'walking', a track of this program?" replay walkin
cat >"$folder/room.yaml" <<'END'
version: 1
eye: [0, 1600, 2000]
grid: {columns: 1, rows: 1, centre: [0, 1500, 0], tile: {width: 1600, height: 900, pixels: [32, 18]}}
trackers:
  - {source: Tracker0@h, unit: mm, axes: z-up, viewers: [{head: 3, gaze: head}]}
END
{
    echo arrival_s,sender,kind,sensor,x,y,z,qx,qy,qz,qw
    for i in $(seq 0 30); do echo "0.$((10 + i)),Tracker0,pose,3,$((i * 10)),-2000,1600,0,0,0,1"; done
} >"$folder/room.csv"
sed 's/,pose,3,/,pose,0,/' "$folder/room.csv" >"$folder/plain.csv"
expect "a table in millimetres" 0 "unit         31 of 31 positions are more than 50 m from the device's origin with a unit of 1000 mm (m); is it mm?" \
    replay "$folder/plain.csv"
expect "a site that knows its unit" 0 "" replay "$folder/room.csv" --site "$folder/room.yaml" --report "$folder/room.json" --plot "$folder/room.svg"
is "is not suspected" "$(json "$folder/room.json" "['tracking']['suspected_unit']")" None
has "the gaze is drawn on its wall as its trackers say" "$(cat "$folder/room.svg")" "viewer 0, 100 %"
expect "pace without players" 2 "no effect without --serve" replay demo --loop
expect "an unknown option" 2 "did you mean '--info'" replay demo --inof
expect "an unknown level" 2 "--log 'loud'" replay demo --log loud
expect "a table that cannot be written" 5 "nowhere" replay demo --csv "$folder/nowhere/demo.csv"
finish
