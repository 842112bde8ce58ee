#!/bin/bash
# Trackers and frames: a recording gives the same eyes live or not, at any pace and from any moment; a hole in it makes
# no eye jump; what is late is told to the millisecond; a live source is followed.
# shellcheck source=tests/support/tap.sh
. "$(dirname "$0")/../support/tap.sh"
make_scene "$folder/sheet.obj"
common=(--scene "$folder/sheet.obj" --set octree_depth=5 --tiles 1x1 --size 32x24 --headless --quiet)
tracks=$(realpath "$(dirname "$0")/../../configs/tracks")
cd "$folder" || exit 1

sim() { # NAME ARGUMENT...
    local name=$1
    shift
    timeout 300 "$program" sim "${common[@]}" --report "$name.json" "$@" >"$name.log" 2>&1
    is "$name ends well" $? 0
}
eyes() { # STATES FIRST STEP: time, eye and gazes of every STEPth from FIRST on
    python3 - "$@" <<'P'
import json, sys
states = [json.loads(line) for line in open(sys.argv[1])][1:]
for s in states[int(sys.argv[2])::int(sys.argv[3])]:
    print(s["time"], s["eye"], s["gazes"])
P
}
median() { # REPORT STAGE
    json "$1.json" "[\"latency_ms\"][\"$2\"][\"median\"]"
}

# --- the same recording, however it is played
recording=(--track "$tracks/dropouts.vrpn.gz")
sim whole "${recording[@]}" --frames 40 --step 0.1 --time 1 --save-states whole.states
sim live "${recording[@]}" --frames 40 --step 0.1 --time 1 --live --save-states live.states
sim late "${recording[@]}" --frames 10 --step 0.3 --time 2 --save-states late.states
is "live or not, the same eyes" "$(eyes live.states 0 1 | sha1sum)" "$(eyes whole.states 0 1 | sha1sum)"
is "begun later, at a third of the pace, the same eyes" "$(eyes late.states 0 1 | sha1sum)" "$(eyes whole.states 10 3 | sha1sum)"
is "the report tells states and counters" "$(python3 -c "
import json
t = json.load(open('whole.json'))['tracking']
print(t['state'], t['viewers'][0]['head'] in ('fresh', 'held', 'lost', 'returned'), t['tracker']['samples'] > 100)")" "recording True True"

# --- 50 ms more are 50 ms more
sim early --track "$tracks/walking.vrpn.gz" --frames 24 --step 0.1 --time 1 --out early
is "frames.csv and report tell where on the wall the viewer looks, and how surely" "$(python3 - <<'P'
import csv, json
rows = list(csv.DictReader(open("early/frames.csv")))
last = json.load(open("early.json"))["tracking"]["viewers"][0]["fixation"]
known = [r for r in rows if r["fixation0_x_mm"]]
off = []
for r in known:
    eye, gaze = [[float(r[k]) for k in keys] for keys in (("eye_x_mm", "eye_y_mm", "eye_z_mm"), ("gaze_x", "gaze_y", "gaze_z"))]
    meets = [eye[i] - gaze[i] * eye[2] / gaze[2] for i in range(2)]
    off.append(max(abs(meets[i] - float(r["fixation0_" + "xy"[i] + "_mm"])) for i in range(2)))
wide = [float(r["fixation0_wide_deg"]) for r in known]
rests = [o for o, r in zip(off, known) if r["fixation0_rests"] == "1"]
print(len(known) > 16, len(rests) > 12, max(rests) < 60, min(wide) >= 3, max(abs(float(r["fixation0_z_mm"])) for r in known) < 0.01,
      all(not r["fixation1_x_mm"] for r in rows),
      (last is None) == (not rows[-1]["fixation0_x_mm"]) and (last is None or abs(last["point_mm"][0] - float(rows[-1]["fixation0_x_mm"])) < 0.01))
P
)" "True True True True True True True"
sim delayed --track "$tracks/walking.vrpn.gz" --frames 24 --step 0.1 --time 1 --set added_latency=0.05
is "injected 50 ms show as 50 +- 2" "$(python3 -c "
early, late = [$(median early age) + $(median early wait) + $(median early filter), $(median delayed age) + $(median delayed wait) + $(median delayed filter)]
print(abs(late - early - 50) <= 2)")" True
is "and all stages sum to the total" "$(python3 -c "
import csv, subprocess
d = __import__('json').load(open('early.json'))['latency_ms']
print(sorted(d) == sorted('age filter wait trace gate scan_out total predicted'.split()), d['total']['median'] >= d['trace']['median'])")" "True True"
sim filtered --track "$tracks/walking.vrpn.gz" --frames 24 --step 0.1 --time 1 --set head_filter=one-euro --set head_cutoff=4 --set head_cutoff_growth=0
is "a filter tells its delay" "$(median filtered filter | cut -c1-5)" "39.78"

# --- a hole of 3 s, packets twice and out of order, a clock that is set back
sim hole --track "$tracks/dropouts.vrpn.gz" --frames 719 --step 0.0166666667 --save-states hole.states --set geometry=voxels
"$program" replay "$tracks/dropouts.vrpn.gz" --quiet --csv hole.csv >/dev/null
is "no eye jumps by more than 20 mm a frame beyond the raw path" "$(python3 - <<'P'
import csv, json, math
rows = [r for r in csv.DictReader(open("hole.csv")) if r["kind"]]
start = float(rows[0]["arrival_s"])
head = [(float(r["arrival_s"]) - start, [1000 * float(r[k]) for k in "xyz"]) for r in rows
        if r["kind"] == "pose" and r["sensor"] == "0" and float(r["quality"]) >= 0]
states = [json.loads(line) for line in open("hole.states")][1:]
worst, raw, before, at = 0, None, None, 0
for s in states:
    while at < len(head) and head[at][0] <= s["time"] * 1e-9:
        at += 1
    sample = head[max(at - 1, 0)][1]
    if before:
        worst = max(worst, math.dist(s["eye"], before) - math.dist(sample, raw))
    before, raw = s["eye"], sample
print(worst <= 20, worst > 5)
P
)" "True True"
is "what was wrong is counted" "$(python3 -c "
import json
t = json.load(open('hole.json'))['tracking']['tracker']
print(t['duplicated'] > 0, t['reordered'] > 0, t['clock_steps'] >= 1, t['losses'] >= 2)")" "True True True True"

# --- a live source
cat >path.yaml <<'Y'
version: 1
keys:
  - {time: 0, position: [-300, 100, 1800], look_at: [-500, 0, 0]}
  - {time: 1, position: [300, 100, 1800], look_at: [500, 0, 0]}
  - {time: 2, position: [-300, 100, 1800], look_at: [-500, 0, 0]}
Y
sim followed --track path:path.yaml --frames 60 --save-states followed.states
is "a live source is followed" "$(python3 -c "
import json
eyes = [json.loads(line)['eye'] for line in list(open('followed.states'))[1:]]
gazes = json.loads(list(open('followed.states'))[-1])['gazes']
off = [abs(e[1] - 100) + abs(e[2] - 1800) for e in (eyes[0], eyes[-1])]
print(gazes != [], off[1] < off[0] or off[1] < 1, len({e[0] for e in eyes}) > 5)")" "True True True"
is "and its state told" "$(json followed.json '["tracking"]["state"]') $(json followed.json '["tracking"]["sources"][0]["events"] > 20')" "live True"
is "the frame's own time is predicted" "$(json followed.json '["latency_ms"]["predicted"]["median"] > 5')" True
expect "a source that is none" 2 "nowhere.yaml: cannot be opened" sim "${common[@]}" --track path:nowhere.yaml --frames 1
is "nothing is left in shared memory" "$(find /dev/shm -name "gazewall-*" -user "$(id -u)" -mmin +2 2>/dev/null | wc -l)" 0
finish
