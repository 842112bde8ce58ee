#!/bin/bash
# Any split of a wall, by any number of ranks, gives the same pixels, bit for bit, as one process without MPI.
# shellcheck source=tests/support/tap.sh
. "$(dirname "$0")/../support/tap.sh"
make_scene "$folder/sheet.obj"
common=(--scene "$folder/sheet.obj" --set octree_depth=7 --quiet)
tracks=$(realpath "$(dirname "$0")/../../configs/tracks")
cd "$folder" || exit 1

sim() { # NAME ARGUMENT...: into folder NAME
    local name=$1
    shift
    timeout 300 "$program" sim "${common[@]}" --out "$name" --report "$name/report.json" "$@" >"$name.log" 2>&1
    local code=$?
    is "sim $name ends well" $code 0
    [ $code -eq 0 ] || sed 's/^/# /' "$name.log"
}

# --- one frame, a gaze from the command line: the wall and render
view=(--gaze "50,40")
expect "render" 0 "" render "${common[@]}" --size 161x97 "${view[@]}" --out render.png --report render.json
sim 1x1 --tiles 1x1 --size 161x97 "${view[@]}"
sim 2x2 --tiles 2x2 --size 161x97 "${view[@]}"
sim 3x1 --tiles 3x1 --size 161x97 "${view[@]}"
sim uneven --columns 70,20,71 --rows 33,64 "${view[@]}"
# Two machines, pretended: the octree's bytes go by MPI from the first rank of one to the first rank of the other.
sim machines --tiles 3x1 --size 161x97 "${view[@]}" --machines 2
wanted=$(json render.json '["image"]["hash"]')
is "the hash has 32 digits" "${#wanted}" 32
for name in 1x1 2x2 3x1 uneven machines; do
    is "$name has render's pixels" "$(json $name/report.json '["image"]["hash"]')" "$wanted"
done
for name in 2x2 3x1 uneven; do
    same_file "$name/wall.png is 1x1's" $name/wall.png 1x1/wall.png
done
is "the gaze counts" "$("$program" render "${common[@]}" --size 161x97 --no-gaze --set tau=8 --set tau_inside=8 --out blunt.png --report blunt.json &&
    [ "$(json blunt.json '["image"]["hash"]')" != "$wanted" ] && echo differs)" differs

# --- two eyes: rows of the wall, whichever tile they stand in; the format's own needs are told
sim rows-1x1 --tiles 1x1 --size 161x97 "${view[@]}" --stereo row-interlace
sim rows-uneven --columns 70,91 --rows 33,64 "${view[@]}" --stereo row-interlace
same_file "interlaced rows do not know the split" rows-uneven/wall.png rows-1x1/wall.png
is "two eyes are not one" "$(cmp -s rows-1x1/wall.png 1x1/wall.png || echo differ)" differ
expect "half of an odd width" 2 "tile 'c0r0' is 161 px wide; side by side" sim --tiles 1x1 --size 161x97 --stereo side-by-side
expect "an unknown mode" 2 "did you mean anaglyph" sim --stereo anagliph

# --- a recording gives the same pictures each time, whatever the split; one that is cut off, up to there
recording=$tracks/two-viewers.vrpn.gz
head -c 70000 "$recording" >cut.vrpn.gz
sim recorded --track "$recording" --tiles 1x1 --size 160x90 --frames 3 --step 1.7
sim recorded-3x2 --track "$recording" --tiles 3x2 --size 160x90 --frames 3 --step 1.7
sim recorded-cut --track cut.vrpn.gz --tiles 2x1 --size 160x90 --frames 3 --step 1.7
for frame in 0000 0001 0002; do
    same_file "frame $frame of a recording, another split" recorded-3x2/wall-$frame.png recorded/wall-$frame.png
    same_file "frame $frame of a recording that is cut off" recorded-cut/wall-$frame.png recorded/wall-$frame.png
done
is "its frames differ" "$(cmp -s recorded/wall-0001.png recorded/wall-0002.png || echo differ)" differ
is "two people look" "$(awk -F, 'NR == 4 { print $7 }' recorded/frames.csv)" 2
is "the report of a whole recording" "$(json recorded/report.json '["tracking"]["damage"]')" None
is "the report says where the cut is" "$(json recorded-cut/report.json '["tracking"]["damage"]["text"]' | grep -c 'gzip stream is cut off at byte 70000')" 1

# --- frames from the track: states, and their repetition
sim track --tiles 2x1 --size 160x96 --frames 3 --save-states states.json
sim again --tiles 1x2 --size 160x96 --states states.json
for frame in 0000 0001 0002; do
    same_file "frame $frame from its state" again/wall-$frame.png track/wall-$frame.png
done
is "the frames differ" "$(cat track/wall-000?.png | wc -c | awk '{ print ($1 > 0) }')$(cmp -s track/wall-0000.png track/wall-0001.png || echo differs)" 1differs
expect "render from a state" 0 "" render "${common[@]}" --size 160x96 --states states.json --frame 1 --report state.json --out state.png
is "a row per frame" "$(wc -l <track/frames.csv)" 4
is "the last frame has a plain name" "$(cmp track/wall.png track/wall-0002.png && echo same)" same
is "no frame is incomplete" "$(find . -name '*incomplete*' | wc -l)" 0
is "the states are recorded as sent" "$(wc -l <states.json)" 4
python3 - track/tile-c0r0-0001.png track/tile-c1r0-0001.png track/wall-0001.png state.png >tiles.log 2>&1 <<'P'
import struct, sys, zlib
def pixels(path):
    data, at, parts = open(path, "rb").read(), 8, b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        if kind == b"IHDR":
            width, height, depth, color = struct.unpack(">IIBB", data[at + 8:at + 18])
            assert depth == 8 and color == 2
        if kind == b"IDAT":
            parts += data[at + 8:at + 8 + size]
        at += size + 12
    raw, stride, rows, before = zlib.decompress(parts), width * 3, [], bytearray(width * 3)
    for y in range(height):
        kind, row = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for i in range(stride):
            a = row[i - 3] if i > 2 else 0
            b, c = before[i], before[i - 3] if i > 2 else 0
            p = a + b - c
            paeth = min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]
            row[i] = (row[i] + (0, a, b, (a + b) // 2, paeth)[kind]) & 255
        rows.append(bytes(row))
        before = row
    return rows
left, right, wall, state = map(pixels, sys.argv[1:])
assert [a + b for a, b in zip(left, right)] == wall, "tiles side by side are not the wall"
assert state == wall, "render from the state differs from the wall"
print("same")
P
is "the tiles side by side are the wall, and render's picture of that state, too" "$(cat tiles.log)" same

# --- bezels
sim bezels --tiles 2x1 --size 160x96 --bezel 50 --wall-width 1600 "${view[@]}"
is "bezels of 5 px on every side" "$(python3 -c 'import struct; print(*struct.unpack(">II", open("bezels/wall-bezels.png", "rb").read(24)[16:]))')" "180 106"
is "the picture without them" "$(python3 -c 'import struct; print(*struct.unpack(">II", open("bezels/wall.png", "rb").read(24)[16:]))')" "160 96"
is "every key of the report" "$(python3 -c '
import json
keys = "version command device scene octree memory tiles frames ended frame_ms counters effects profile settings predicted_error latency_ms gate swap_skew_ms tracking float_environment build image site_reloads lights".split()
d = json.load(open("track/report.json"))
print(" ".join(d) == " ".join(keys), [k for k in keys if d[k] is None])')" "True ['memory']"
is "the octree's hash is the same for all" "$(for name in 1x1 2x2 3x1 uneven track again; do json $name/report.json '["octree"]["hash"]'; done | sort -u | wc -l)" 1
is "the command is the user's" "$(json 2x2/report.json '["command"][:13]')" "gazewall sim "
is "nothing is left in shared memory" "$(find /dev/shm -name "gazewall-*" -user "$(id -u)" -mmin +2 2>/dev/null | wc -l)" 0
finish
