#!/bin/bash
# gazewall bench accuracy: the ledger of a small scene; a run that was cut goes on; a planted error is flagged; a search
# writes a profile that other commands take.
cd "$(dirname "$0")/../.." || exit 1
. tests/support/tap.sh

make_scene "$folder/sheet.obj"
small=(--quick --size 32x18 --set octree_depth=5)
ledger() { # OUT ARGUMENT...
    local out=$1
    shift
    "$program" bench accuracy "$folder/sheet.obj" "${small[@]}" --out "$out" "$@" 2>&1 </dev/null
}
results=$folder/ledger

expect "knobs that are none" 2 "did you mean 'tau'" bench accuracy --knob tua
expect "two goals" 2 "leave out one" bench accuracy --max-error 1 --max-cost work=1
expect "a cost that is none" 2 "did you mean 'rays'" bench accuracy --max-cost ray=1
expect "knobs of trackers" 2 "gazewall bench tracking measures it" bench accuracy --knob head_cutoff
expect "bounds in time of one frame" 2 "add --frames" bench accuracy --max-error flicker=1
expect "knobs of other benches" 2 "has no use for --knob" bench effects --knob tau

has "the ledger of a small scene" "$(ledger "$results" --knob tau)" "7 frames measured, 0 known"
is "a row for every value" "$(cut -d, -f2 "$results/accuracy.csv" | sort | uniq -c | tr -s ' \n' ' ')" " 1 knob 6 tau "
is "every row has every column" "$(awk -F, '{print NF}' "$results/accuracy.csv" | sort -u | wc -l)" 1
is "no fault in a sound program" "$(python3 -c 'import json, sys
b = json.load(open(sys.argv[1]))["bench"]
print(b["faults"], [c["knob"] for c in b["scenes"][0]["curves"]])' "$results/accuracy.json")" "0 ['tau']"
is "at its exact value a knob has no error" \
    "$(python3 -c 'import csv, sys
print([r["own_flip"] for r in csv.DictReader(open(sys.argv[1])) if r["value"] == "0"])' "$results/accuracy.csv")" "['0']"
is "and finds the depths and silhouettes of exact triangles, which voxels have not" \
    "$(python3 -c 'import csv, sys
rows = {r["value"]: r for r in csv.DictReader(open(sys.argv[1]))}
names = ["hit_mismatch", "depth_95", "normal_95", "silhouette_hausdorff"]
print([float(rows["0"][n]) for n in names], float(rows["4"]["depth_95"]) > 0.5, rows["4"]["flicker"] == "")' "$results/accuracy.csv")" \
    "[0.0, 0.0, 0.0, 0.0] True True"
has "a sentence for each knob, over all scenes" "$(cat "$results/accuracy.md")" '(1) sheet:'
is "the page stands alone" "$(python3 -c 'import html.parser, re, sys
text = open(sys.argv[1]).read()
class Page(html.parser.HTMLParser):
    tags = []
    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        for name, value in attributes:
            assert name not in ("src", "srcset") and not (name == "href" and not value.startswith("#")), value
Page().feed(text)
assert not re.search(r"url\((?!data:)", text)
print("svg" in Page.tags, "table" in Page.tags, "script" in Page.tags, text.count("data:image/png") >= 3)' \
    "$results/accuracy.html")" "True True False True"
is "plots are pictures" "$(file -b "$results"/sheet/front.png | cut -d, -f1,2)" "PNG image data, 720 x 440"

before=$(cut -d, -f1-8 "$results/accuracy.csv" | md5sum)
has "what is known is not measured again" "$(ledger "$results" --knob tau)" "0 frames measured, 7 known"
truncate -s -200 "$results/sheet/points.jsonl"
has "a run that was cut goes on" "$(ledger "$results" --knob tau)" "1 frames measured, 6 known"
is "and comes to the same" "$(cut -d, -f1-8 "$results/accuracy.csv" | md5sum)" "$before"

has "frames in a row tell flicker" "$(ledger "$folder/moving" --knob samples --frames 3)" "flicker       pop"
is "which more samples lessen, and the exact frame has none of" "$(python3 -c 'import csv, sys
rows = {r["value"]: float(r["flicker"]) for r in csv.DictReader(open(sys.argv[1]))}
print(rows["16"] == 0 < rows["4"] < rows["1"] < 0.5)' "$folder/moving/accuracy.csv")" True

# Ctrl-C at whatever moment: what was written is whole, and the next run goes on where it was.
interrupted() { # SECONDS POINTS
    "$program" bench accuracy "$folder/sheet.obj" "${small[@]}" --out "$folder/interrupted" --quiet 2>/dev/null </dev/null &
    local run=$!
    # More points than before, then so long.
    for _ in $(seq 300); do
        [ "$(grep -sc '' "$folder/interrupted/sheet/points.jsonl")" -gt "$2" ] 2>/dev/null && break
        sleep 0.1
    done
    sleep "$1"
    kill -INT $run
    wait $run 2>/dev/null
    is "Ctrl-C $1 s after a point: exit code" $? 130
    is "Ctrl-C $1 s after a point: whole lines, whole pictures, nothing beside them" "$(python3 -c 'import glob, json, os, sys, zlib
folder = sys.argv[1]
for line in open(folder + "/sheet/points.jsonl"):
    assert line.endswith("\n") and len(json.loads(line)["key"]) == 32, line
for path in glob.glob(folder + "/sheet/*.png"):
    data = open(path, "rb").read()
    at, end = 8, None
    while at < len(data):
        length, end = int.from_bytes(data[at:at + 4], "big"), data[at + 4:at + 8]
        assert zlib.crc32(data[at + 4:at + 8 + length]) == int.from_bytes(data[at + 8 + length:at + 12 + length], "big"), path
        at += 12 + length
    assert end == b"IEND" and at == len(data), path
print(sorted({os.path.splitext(f)[1] for _, _, files in os.walk(folder) for f in files} - {".png", ".jsonl"}))' "$folder/interrupted")" "[]"
}
interrupted 0.1 0
kept=$(wc -l <"$folder/interrupted/sheet/points.jsonl")
interrupted 0.3 "$kept"
is "Ctrl-C: the second run kept what the first had, and more" "$([ "$(wc -l <"$folder/interrupted/sheet/points.jsonl")" -gt "$kept" ] && echo more)" more
has "Ctrl-C: a third run has it" "$(ledger "$folder/interrupted" --knob tau)" "known before"
is "Ctrl-C: and measures nothing twice" "$(cut -c1-42 "$folder/interrupted/sheet/points.jsonl" | sort | uniq -d | wc -l)" 0

# Between tau 0.2 and 0.6 voxels are drawn as for 16 times as much.
cp -R shaders "$folder/shaders"
sed -i 's/precise float tau = frame.accuracy.y +/precise float tau = (frame.accuracy.x > 0.2 \&\& frame.accuracy.x < 0.6 ? 16.0 : 1.0) * frame.accuracy.y + (frame.accuracy.x > 0.2 \&\& frame.accuracy.x < 0.6 ? 16.0 : 1.0) */' \
    "$folder/shaders/trace/gaze.glsl"
has "an error that is planted in a knob is flagged" "$(ledger "$folder/planted" --knob tau --shaders "$folder/shaders")" \
    "FAULT tau: its error rises"

has "the cheapest settings within an error" \
    "$(ledger "$results" --knob tau --knob samples --max-error flip=0.08 --save-profile "$folder/mine.yaml")" "flip at most 0.08 in sheet"
expect "take a profile" 0 "" render --scene "$folder/sheet.obj" --profile "$folder/mine.yaml" --set octree_depth=5 --size 16x16 \
    --set tau_inside=0.5 --report "$folder/report.json" --quiet
is "which the report states, and what else was set" "$(python3 -c 'import json, sys
p = json.load(open(sys.argv[1]))["profile"]
print(p["name"], p["changed"])' "$folder/report.json")" "mine ['tau_inside']"
expect "a profile that is none" 2 "draft, show, study and exact" render --profile shwo

finish
