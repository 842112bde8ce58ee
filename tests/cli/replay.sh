#!/bin/bash
# gazewall replay: what it says of good tracks, and that bad ones and bad command lines end in one clear sentence.
set -u
program=${GAZEWALL:-out/gazewall}
folder=${GW_TEST_FOLDER:-$(mktemp -d)}
root=$(cd "$(dirname "$0")/../.." && pwd)
demo=$root/configs/tracks/demo.vrpn
number=0

# expect NAME CODE TEXT ARGUMENT...: exit code, and a part of what is printed (either stream)
expect() {
    local name=$1 code=$2 text=$3 output got
    shift 3
    output=$(timeout 60 "$program" replay "$@" 2>&1)
    got=$?
    number=$((number + 1))
    if [ "$got" -eq "$code" ] && [[ $output == *"$text"* ]]; then
        echo "ok $number - $name"
    else
        echo "not ok $number - $name"
        printf '# exit %s, wanted %s; wanted "%s" in:\n%s\n' "$got" "$code" "$text" "$output" | sed 's/^/# /'
    fi
}

is() { # NAME GOT WANTED
    number=$((number + 1))
    if [ "$2" = "$3" ]; then
        echo "ok $number - $1"
    else
        printf 'not ok %s - %s\n# got "%s", wanted "%s"\n' "$number" "$1" "$2" "$3"
    fi
}

size=$(stat -c %s "$demo")
head -c $((size - 5)) "$demo" > "$folder/cut.vrpn"
head -c 24 "$demo" > "$folder/bare.vrpn"
head -c 23 "$demo" > "$folder/short.vrpn"
: > "$folder/empty.vrpn"
{ printf 'vrpn: ver. 08.00'; tail -c +17 "$demo"; } > "$folder/future.vrpn"
{ head -c 40 "$demo"; printf '\177\377\377\377'; tail -c +45 "$demo"; } > "$folder/long.vrpn"
cut -c 1-40 "$root/README.md" > "$folder/text.vrpn"

expect "the demo track" 0 "sensor 1 gaze: 481 poses from 0.000 to 8.000 s, 60.0 Hz" demo --info
expect "its file" 0 "0 skipped" "$demo"
expect "its device by name" 0 "sender       Demo0" "$demo" --sender Demo0
expect "help" 0 "Usage: gazewall replay" --help
expect "a table" 0 "" "$demo" --csv "$folder/demo.csv"
is "one row per pose" "$(wc -l < "$folder/demo.csv")" 963
is "the table's head" "$(head -1 "$folder/demo.csv")" "time_s,sensor,x_mm,y_mm,z_mm,qx,qy,qz,qw"
is "seconds and millimetres" "$(awk -F, 'NR == 963 { print ($1 == 8 && $5 > 1500 && $5 < 2000) }' "$folder/demo.csv")" 1
expect "no track" 2 "name a track" --info
expect "two tracks" 2 "one track at a time" "$demo" "$demo"
expect "a missing file" 2 "nowhere.vrpn" "$folder/nowhere.vrpn"
expect "a folder" 2 "folder" "$folder"
expect "an empty file" 2 "byte 0: not a VRPN log" "$folder/empty.vrpn"
expect "half a cookie" 2 "byte 0: not a VRPN log" "$folder/short.vrpn"
expect "another kind of file" 2 "byte 0: not a VRPN log" "$folder/text.vrpn"
expect "a later major version" 2 "major version 4 to 7" "$folder/future.vrpn"
expect "a cut record" 2 "byte $((size - 88)): the record is cut off" "$folder/cut.vrpn"
expect "a length beyond the file" 2 "byte 24: the record is cut off" "$folder/long.vrpn"
expect "a log without poses" 2 "no usable pose" "$folder/bare.vrpn"
expect "an unknown device" 2 "senders: Demo0" "$demo" --sender Wand
expect "an unknown option" 2 "did you mean '--info'" demo --inof
expect "an unknown level" 2 "--log 'loud'" demo --log loud
expect "a table that cannot be written" 5 "nowhere" demo --csv "$folder/nowhere/demo.csv"
echo "1..$number"
[ -n "${GW_TEST_FOLDER:-}" ] || rm -rf "$folder"
