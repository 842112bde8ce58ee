#!/bin/bash
# gazewall compare: two pictures, asked of other programs, too; a recorded run frame by frame; what it refuses.
cd "$(dirname "$0")/../.." || exit 1
. tests/support/tap.sh

exact=tests/data/pair_exact.png
other=tests/data/pair_approximate.png
expect "two pictures" 0 "structural similarity" compare "$exact" "$other" --csv "$folder/pair.csv" --report "$folder/pair.json"
is "names and values" "$(awk -F, '{print NF}' "$folder/pair.csv" | sort -u | wc -l)" 1
is "equal pictures" "$("$program" compare "$exact" "$exact" | awk '$1 == "psnr" || $1 == "ssim" || $1 == "flip" {printf "%s ", $2}')" \
    "inf 1 0 "
expect "seen by who looks there" 0 "behind the viewers" compare "$exact" "$other" --gaze 30,30 --density 10
is "swapped, the bias changes its sign and nothing else" \
    "$("$program" compare "$other" "$exact" | awk '$1 == "bias" {print $2}')" \
    "$("$program" compare "$exact" "$other" | awk '$1 == "bias" {print -$2}')"

value() { # NAME: of the pair's report
    json "$folder/pair.json" "[\"metrics\"][\"$1\"]"
}
near() { # A B: to 1e-4
    awk -v a="$1" -v b="$2" 'BEGIN {print (a - b < 1e-4 && b - a < 1e-4 && b != "" ? "yes" : a " and " b)}'
}
if command -v ffmpeg >/dev/null; then
    theirs=$(ffmpeg -hide_banner -nostats -i "$exact" -i "$other" -lavfi '[0]format=gbrp[a];[1]format=gbrp[b];[a][b]psnr' \
        -f null - 2>&1 | sed -n 's/.*PSNR .*average:\([0-9.]*\).*/\1/p')
    is "ffmpeg's PSNR" "$(near "$(value psnr)" "$theirs")" yes
else
    number=$((number + 1))
    echo "ok $number - ffmpeg's PSNR # SKIP ffmpeg is not installed"
fi
if command -v compare >/dev/null; then
    theirs=$(compare -metric RMSE "$exact" "$other" null: 2>&1 | sed 's/.*(\(.*\)).*/\1/')
    is "ImageMagick's error" "$(near "$(value psnr | awk '{print exp(-$1 / 20 * log(10))}')" "$theirs")" yes
else
    number=$((number + 1))
    echo "ok $number - ImageMagick's error # SKIP ImageMagick is not installed"
fi

make_scene "$folder/sheet.obj"
run=("$program" sim --scene "$folder/sheet.obj" --tiles 1x1 --size 48x32 --frames 2 --set octree_depth=5 --quiet --cache none)
"${run[@]}" --save-states "$folder/run.states" >/dev/null
expect "a run against the exact one" 0 "Hausdorff" compare --states "$folder/run.states" --scene "$folder/sheet.obj" --size 48x32 \
    --set octree_depth=5 --cache none --csv "$folder/run.csv" --out "$folder/pairs" --luminance 250
is "a row for each frame" "$(wc -l <"$folder/run.csv")" 3
is "of one width" "$(awk -F, '{print NF}' "$folder/run.csv" | sort -u | wc -l)" 1
is "work and error in one row" "$(python3 -I -S -c 'import csv, sys
rows = list(csv.DictReader(open(sys.argv[1])))
print(all(float(r["rays"]) > 0 and float(r["flip"]) >= 0 and float(r["px_per_degree"]) >= 1 for r in rows))' "$folder/run.csv")" True
exists "pairs of frames" "$folder/pairs/test-00001.png"
exists "with their references" "$folder/pairs/reference-00001.png"
is "fixations" "$(head -1 "$folder/pairs/fixations.csv")" "frame,time_s,x,y,distance_mm"
is "the display has the keys that FovVideoVDP asks for" "$(python3 -I -S -c 'import json, math, sys
d = json.load(open(sys.argv[1]))["gazewall"]
width = 25.4 * d["diagonal_size_inches"] / math.hypot(*d["resolution"]) * d["resolution"][0]
print(d["resolution"], d["max_luminance"], round(width), 1 < d["viewing_distance_meters"] < 3)' \
    "$folder/pairs/display_models.json")" "[48, 32] 250.0 2000 True"

# As a program that knows only the table in docs/metrics.md and FovVideoVDP's own formulas would read it.
is "and all of the export is as a reader of its own finds it" "$(python3 -I -S -c 'import csv, json, math, os, sys, zlib
folder = sys.argv[1]
def picture(name):
    data = open(os.path.join(folder, name), "rb").read()
    assert data[:8] == b"\x89PNG\r\n\x1a\n", name
    at, packed = 8, b""
    while at < len(data):
        size, kind = int.from_bytes(data[at:at + 4], "big"), data[at + 4:at + 8]
        body = data[at + 8:at + 8 + size]
        assert zlib.crc32(kind + body) == int.from_bytes(data[at + 8 + size:at + 12 + size], "big"), name
        head = body if kind == b"IHDR" else head
        packed += body if kind == b"IDAT" else b""
        at += 12 + size
    width, height, depth, colour = int.from_bytes(head[:4], "big"), int.from_bytes(head[4:8], "big"), head[8], head[9]
    channels = {2: 3, 6: 4}[colour]
    assert depth == 8 and len(zlib.decompress(packed)) == height * (1 + channels * width), name
    return width, height
rows = list(csv.DictReader(open(os.path.join(folder, "fixations.csv"))))
names = ["%s-%05d.png" % (kind, i) for kind in ("reference", "test") for i in range(len(rows))]
assert sorted(os.listdir(folder)) == sorted(names + ["display_models.json", "fixations.csv"]), os.listdir(folder)
(name, display), = json.load(open(os.path.join(folder, "display_models.json"))).items()
width, height = display["resolution"]
assert name == "gazewall" and {picture(n) for n in names} == {(width, height)}
run = list(csv.DictReader(open(sys.argv[2])))
assert len(run) == len(rows) and [int(r["frame"]) for r in rows] == list(range(len(rows)))
for r, other in zip(rows, run):
    assert abs(float(r["time_s"]) - float(other["time_s"])) < 1e-6
    assert (r["x"], r["y"]) == (other["gaze_x_px"], other["gaze_y_px"])
    assert r["x"] == "" or math.isfinite(float(r["x"])) and math.isfinite(float(r["y"]))
distances = [float(r["distance_mm"]) for r in rows]
assert abs(display["viewing_distance_meters"] - sum(distances) / len(distances) / 1000) < 1e-4
# vvdp_display_geometry: size from the diagonal, pixels a degree in the middle of the display.
ratio, diagonal = width / height, display["diagonal_size_inches"] * 25.4
height_mm = math.sqrt(diagonal ** 2 / (1 + ratio ** 2))
size = math.degrees(2 * math.atan(0.5 * ratio * height_mm / width / 1000 / display["viewing_distance_meters"]))
density = sum(float(r["px_per_degree"]) for r in run) / len(run)
assert abs(ratio * height_mm - 2000) < 1 and abs(1 / size * 2000 / width / math.tan(math.radians(1)) / (sum(distances) / len(distances)) - 1) < 0.01
assert abs(max(1 / size, 1) / density - 1) < 0.02, (1 / size, density)
print(len(rows), width, height)' "$folder/pairs" "$folder/run.csv")" "2 48 32"

expect "no picture" 2 "say what to compare" compare
expect "one picture" 2 "say what to compare" compare "$exact"
expect "three pictures" 2 "one picture too many" compare "$exact" "$other" "$exact"
expect "sizes that differ" 2 "cannot be compared" compare "$exact" tests/data/mask.png
expect "no picture of that name" 2 "nowhere.png" compare "$exact" nowhere.png
expect "a picture that is none" 2 "box.obj" compare "$exact" tests/data/box.obj
expect "a gaze beside it" 2 "not on the picture" compare "$exact" "$other" --gaze 500,0
expect "what is not heeded" 2 "has no use for --out" compare "$exact" "$other" --out "$folder/x"
expect "pictures and a run" 2 "leave out one" compare "$exact" "$other" --states "$folder/run.states"
expect "a setting that states hold" 2 "--states" compare --states "$folder/run.states" --set tau=0

finish
