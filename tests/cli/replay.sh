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
expect "pace without players" 2 "no effect without --serve" replay demo --loop
expect "an unknown option" 2 "did you mean '--info'" replay demo --inof
expect "an unknown level" 2 "--log 'loud'" replay demo --log loud
expect "a table that cannot be written" 5 "nowhere" replay demo --csv "$folder/nowhere/demo.csv"
finish
