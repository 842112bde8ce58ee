#!/bin/bash
# The verb calibrate: the examples of docs/calibrate.md word by word, positions from a recording, exit codes.
# shellcheck source=tests/support/tap.sh
. "$(dirname "$0")/../support/tap.sh"
root=$(cd "$(dirname "$0")/../.." && pwd)

# block KIND N: the Nth block of that kind in the page
block() {
    awk -v kind="$1" -v wanted="$2" '$0 == "```" kind { n++; on = n == wanted; next } /^```/ { on = 0 } on' \
        "$root/docs/calibrate.md"
}
block yaml 1 >"$folder/marks.yaml"
block text 1 >"$folder/wanted.txt"
"$program" calibrate --points "$folder/marks.yaml" >"$folder/got.txt"
same_file "the page's marks give what the page prints" "$folder/got.txt" "$folder/wanted.txt"
block yaml 2 >"$folder/gazes.yaml"
block text 2 >"$folder/wanted.txt"
"$program" calibrate --gaze "$folder/gazes.yaml" >"$folder/got.txt"
same_file "the page's gazes give what the page prints" "$folder/got.txt" "$folder/wanted.txt"

"$program" calibrate --points "$folder/marks.yaml" --quiet --out "$folder/trackers.yaml"
{ printf 'version: 1\ngrid: {columns: 1, rows: 1, tile: {width: 400, height: 300, pixels: [40, 30]}}\n'
    cat "$folder/trackers.yaml"; } >"$folder/wall.yaml"
expect "what it writes goes into a site file" 0 "tracker 1: Tracker0@10.0.0.5, unit m, axes x z -y, origin at [-1200.24" \
    check "$folder/wall.yaml"

# The same marks by when the sensor was there: half a second at each, on the way between them it is elsewhere.
{
    echo arrival_s,sensor,x,y,z,qx,qy,qz,qw
    echo 0,0,9,9,9,0,0,0,1
    awk -F'[][]' '/name/ { split($4, d, ", "); for (i = 0; i < 10; i++)
        printf "%.3f,0,%s,%s,%s,0,0,0,1\n%.3f,0,9,9,9,0,0,0,1\n", NR + i / 20, d[1], d[2], d[3], NR + 0.6 + i / 40 }' \
        "$folder/marks.yaml"
} >"$folder/walk.csv"
awk '/name/ { sub(/device: .*}/, "time: [" NR ", " NR + 0.5 "]}") } 1' "$folder/marks.yaml" >"$folder/timed.yaml"
"$program" calibrate "$folder/walk.csv" --points "$folder/timed.yaml" --quiet >"$folder/got.txt"
same_file "a recording in which the sensor was there gives the same" "$folder/got.txt" "$folder/trackers.yaml"

expect "no file" 2 "name the marks with --points FILE" calibrate
expect "a file that is not there" 2 "no-such" calibrate --points "$folder/no-such.yaml"
expect "both at once" 2 "one at a time" calibrate --points a --gaze b
expect "two sources" 2 "'b' is a second one after 'a'" calibrate a b --points "$folder/marks.yaml"
expect "times without a recording" 2 "mark 'cross' has no 'device' position; name the recording" \
    calibrate --points "$folder/timed.yaml"
expect "a recording without that sensor" 2 "has no position of sensor 5 from" \
    calibrate "$root/configs/tracks/demo.vrpn" --points "$folder/timed.yaml" --sensor 5
sed 's/\[0, 0, 1500\]/[0, 0]/' "$folder/marks.yaml" >"$folder/wrong.yaml"
expect "an error is told with its line" 2 "wrong.yaml:5: key 'wall': expected 3 numbers, found 2" \
    calibrate --points "$folder/wrong.yaml"
head -6 "$folder/marks.yaml" >"$folder/few.yaml"
expect "two marks" 2 "few.yaml: 2 points; at least 3" calibrate --points "$folder/few.yaml"
head -8 "$folder/marks.yaml" >"$folder/flat.yaml"
expect "marks on the floor" 0 "cannot tell a left-handed device" calibrate --points "$folder/flat.yaml"
expect "a folder that is not there" 5 "nowhere" calibrate --points "$folder/marks.yaml" --out "$folder/nowhere/a.yaml"
expect "help names the page" 0 "docs/calibrate.md" calibrate --help
finish
