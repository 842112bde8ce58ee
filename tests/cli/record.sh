#!/bin/bash
# gazewall record: what replay plays it records, gazes only with consent; files are kept, and whole to the last second.
# shellcheck source=tests/support/tap.sh
. "$(dirname "$0")/../support/tap.sh"
root=$(cd "$(dirname "$0")/../.." && pwd)
dropouts=$root/configs/tracks/dropouts.vrpn.gz

# play TRACK OPTION...: a VRPN server on a free port, which comes back in $port
play() {
    rm -f "$folder/play.log"
    timeout 60 "$program" replay "$@" --serve vrpn:127.0.0.1:0 > "$folder/play.log" &
    player=$!
    until port=$(sed -n 's/^serving .* port \([0-9]*\)$/\1/p' "$folder/play.log" 2>/dev/null) && [ -n "$port" ]; do sleep 0.02; done
}

# events FILE EXPRESSION: Python over the report's sensors, s[kind, number]
events() {
    "$program" replay "$1" --report "$folder/r.json" && python3 - "$folder/r.json" "$2" <<'PY'
import json, sys
t = json.load(open(sys.argv[1]))["tracking"]
s = {(x["kind"], x["sensor"]): x for x in t["sensors"]}
print(eval(sys.argv[2]))
PY
}

expect "no track" 2 "name a source and the track" record Tracker0@localhost
expect "no such kind" 2 "the kinds are standing" record generate:flying "$folder/x.vrpn"
expect "a source that is none" 2 "" record nonsense: "$folder/x.vrpn"
expect "sensors that are none" 2 "--gaze-sensors '1,x'" record Tracker0@localhost "$folder/x.vrpn" --gaze-sensors 1,x
expect "people made by formula" 0 "90 events in 0.4" record generate:standing "$folder/one.csv.gz" --seconds 0.5 --seed 9
expect "a file that is there stays" 2 "--overwrite replaces it" record generate:standing "$folder/one.csv.gz"
expect "a full disk" 5 "No space left" record generate:standing /dev/full
expect "nobody there" 3 "no event came (Tracker0@127.0.0.1:1: " record Tracker0@127.0.0.1:1 "$folder/none.vrpn" --seconds 0.3 --quiet
is "an empty recording leaves no file" "$(ls "$folder/none.vrpn" 2>/dev/null)" ""

# Without consent: heads, buttons and clocks, but not one gaze, in whatever form it came.
play "$dropouts" --to 1.3
expect "without consent" 0 "gazes withheld: 1" record "Synthetic0@127.0.0.1:$port" "$folder/head.vrpn" --seconds 2.5
wait "$player"
is "heads, a button and a clock that is 12 s behind" "$(events "$folder/head.vrpn" \
    '(sorted(s), s["pose", 0]["events"] > 50, round(s["pose", 0]["clock_offset_s"]), t["notes"])')" \
    "([('button', 0), ('link', 0), ('pose', 0)], True, 12, ['gazes: not recorded, without consent'])"
is "no byte of a gaze" "$(grep -c -a 'gazewall Gaze' "$folder/head.vrpn")" 0

# With it: what was played came, sample by sample; Ctrl-C ends it well.
play demo --to 0.5
timeout 60 "$program" record "Demo0@127.0.0.1:$port" "$folder/gaze.vrpn.gz" --consent-gaze > "$folder/gaze.log" 2>&1 &
recorder=$!
wait "$player"
sleep 0.2
kill -INT "$recorder"
wait "$recorder"
is "Ctrl-C is a good end" $? 0
"$program" replay demo --to 0.5 --csv "$folder/played.csv"
"$program" replay "$folder/gaze.vrpn.gz" --csv "$folder/recorded.csv" 2> "$folder/whole.log"
numbers() { awk -F, '$3 == "pose" { print $4, $8, $9, $10, $11, $12, $13, $14 }' "$1"; }
is "every pose and gaze, bit by bit" "$(numbers "$folder/recorded.csv" | md5sum)" "$(numbers "$folder/played.csv" | md5sum)"
is "the file is whole" "$(cat "$folder/whole.log")" ""

# A recorder that is killed leaves all but its last second.
play "$dropouts" --to 2.9
timeout 60 "$program" record "Synthetic0@127.0.0.1:$port" "$folder/killed.vrpn.gz" --quiet &
sleep 0.1
recorder=$(pgrep -P $! | head -1)
wait "$player"
sleep 1.2
kill -9 "$recorder"
wait
is "what was recorded before a kill is there" "$(events "$folder/killed.vrpn.gz" \
    '(s["pose", 0]["events"] > 100, t["damage"]["text"][-40:].startswith("gzip"), "cut off" in t["damage"]["text"])' 2>/dev/null)" "(True, False, True)"
finish
