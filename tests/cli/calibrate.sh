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

# With a person: the first five marks of the page, held one after the other, and a device in millimetres.
head -9 "$folder/marks.yaml" | sed -E '/source/d; s/, device: [^}]*//' >"$folder/live.yaml"
awk -F'[][]' '/name/ { split($4, d, ", "); printf "%.1f %.1f %.1f 1 0 0 0 1 0 0 0 1\n", 1000 * d[1], 1000 * d[2], 1000 * d[3] }' \
    "$folder/marks.yaml" >"$folder/poses.txt"
sed -E 's/wall: \[-900, 510/wall: [-900, 450/' -i "$folder/live.yaml"
python3 "$root/tests/support/hold_sensor.py" "$folder/poses.txt" "$program" calibrate dtrack:127.0.0.1:@PORT@ \
    --points "$folder/live.yaml" --seconds 0.2 >"$folder/got.txt" 2>"$folder/asked.txt"
is "marks are asked for one after the other" "$?" 0
has "and named" "$(cat "$folder/asked.txt")" "mark 5 of 5, 'chair' at [-900, 450, 2000]: hold sensor 0 there and press Enter"
has "a device in millimetres, Z up" "$(cat "$folder/got.txt")" "    unit: mm
    axes: x z -y"
echo - >"$folder/nowhere.txt"
python3 "$root/tests/support/hold_sensor.py" "$folder/nowhere.txt" "$program" calibrate dtrack:127.0.0.1:@PORT@ \
    --points "$folder/live.yaml" --seconds 0.1 2>"$folder/asked.txt"
is "a sensor that is not heard of" "$?" 3
has "and what to do" "$(cat "$folder/asked.txt")" "no other sensor was heard of"
"$program" calibrate null --points "$folder/live.yaml" 2>"$folder/asked.txt" </dev/null
is "nobody presses Enter" "$?" 2
has "and is told so" "$(cat "$folder/asked.txt")" "standard input ended; a person who presses Enter is needed"

# A head that points 2 degrees to the right of each target.
printf '%s\n' 'version: 1' 'eye: [0, 0, 1800]' \
    'grid: {columns: 1, rows: 1, tile: {width: 1600, height: 900, pixels: [160, 90]}}' \
    'trackers: [{source: "dtrack:127.0.0.1:@PORT@", viewers: [{head: 0, gaze: head}]}]' >"$folder/look.yaml"
python3 -c 'import math
for y in 360, 0, -360:
    for x in -640, 0, 640:
        yaw, pitch = math.atan2(x, 1800) + math.radians(2), math.atan2(y, math.hypot(x, 1800))
        f = [math.sin(yaw) * math.cos(pitch), math.sin(pitch), -math.cos(yaw) * math.cos(pitch)]
        r = [math.cos(yaw), 0, math.sin(yaw)]
        u = [r[1] * f[2] - r[2] * f[1], r[2] * f[0] - r[0] * f[2], r[0] * f[1] - r[1] * f[0]]
        print("0 0 1800", *("%.9f" % v for v in r + u + [-v for v in f]))' >"$folder/poses.txt"
python3 "$root/tests/support/hold_sensor.py" "$folder/poses.txt" "$program" calibrate --look "$folder/look.yaml" \
    --seconds 0.1 >"$folder/got.txt" 2>"$folder/asked.txt"
has "gazes at nine targets" "$(cat "$folder/got.txt" "$folder/asked.txt")" "at 9 targets
  on average 1.9"
has "which rest" "$(cat "$folder/asked.txt")" "95 of 100 within 0.0"
has "to the right" "$(cat "$folder/got.txt")" " degrees right and 0.0"

expect "no file" 2 "name the marks with --points FILE" calibrate
expect "a file that is not there" 2 "no-such" calibrate --points "$folder/no-such.yaml"
expect "both at once" 2 "one at a time" calibrate --points a --gaze b
expect "a sensor of gazes" 2 "go with --points" calibrate --gaze a --sensor 3
expect "a site without trackers" 2 "2x2: the site has no 'trackers'" calibrate --look 2x2
expect "two sources" 2 "'b' is a second one after 'a'" calibrate a b --points "$folder/marks.yaml"
expect "times without a recording" 2 "mark 'cross' has no 'device' position; name the tracker, or the recording" \
    calibrate --points "$folder/timed.yaml"
expect "a recording without that sensor" 2 "has no position of sensor 5 from" \
    calibrate "$root/configs/tracks/demo.vrpn" --points "$folder/timed.yaml" --sensor 5
sed 's/\[0, 0, 1500\]/[0, 0]/' "$folder/marks.yaml" >"$folder/wrong.yaml"
expect "an error is told with its line" 2 "wrong.yaml:5: key 'wall': expected 3 numbers, found 2" \
    calibrate --points "$folder/wrong.yaml"
head -6 "$folder/marks.yaml" >"$folder/few.yaml"
expect "a source that nothing is taken from" 2 "'walk.vrpn' would not be read" \
    calibrate walk.vrpn --points "$folder/marks.yaml"
expect "two marks" 2 "few.yaml: 2 points; at least 3" calibrate --points "$folder/few.yaml"
head -8 "$folder/marks.yaml" >"$folder/flat.yaml"
expect "marks on the floor" 0 "cannot tell a left-handed device" calibrate --points "$folder/flat.yaml"
expect "a folder that is not there" 5 "nowhere" calibrate --points "$folder/marks.yaml" --out "$folder/nowhere/a.yaml"
expect "help names the page" 0 "docs/calibrate.md" calibrate --help
finish
