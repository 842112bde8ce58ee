#!/bin/bash
# Budget mode by counted rays: deterministic, in the band after a few frames of a moving gaze, on one tile and on four;
# the decision is in the frame states and repeated from them.
# shellcheck source=tests/support/tap.sh
. "$(dirname "$0")/../support/tap.sh"
make_scene "$folder/sheet.obj"
common=(--scene "$folder/sheet.obj" --set octree_depth=7 --size 320x192 --quiet)
cd "$folder" || exit 1

sim() { # NAME ARGUMENT...: into folder NAME
    local name=$1
    shift
    timeout 300 "$program" sim "${common[@]}" --out "$name" --report "$name/report.json" "$@" >"$name.log" 2>&1
    is "sim $name ends well" $? 0
}

# Frames above the budget after the fifth, and the mean of the others over it.
band() { # NAME BUDGET
    python3 - "$1/frames.csv" "$2" <<'P'
import csv, sys
rays = [int(row["rays"]) / float(sys.argv[2]) for row in csv.DictReader(open(sys.argv[1]))][5:]
print(sum(r > 1.1 for r in rays), sum(r > 1 for r in rays) <= 3, 0.6 < sum(rays) / len(rays) <= 1)
P
}

# A saccade widens the ellipsoid for a frame or two, faster than a budget can foresee: not here.
frames=(--frames 24 --set saccade_growth_limit=0)
sim free --tiles 1x1 "${frames[@]}"
is "without a budget the error is none" "$(json free/report.json '["predicted_error"]["worst"]')" 1.0
is "nor is there a budget" "$(json free/report.json '["predicted_error"]["budget"]')" None
is "and it would be exceeded" "$(python3 -c "
import csv
print(min(int(row['rays']) for row in csv.DictReader(open('free/frames.csv'))) > 36000)")" True

sim one --tiles 1x1 "${frames[@]}" --budget-rays 24000 --save-states one.json
sim twice --tiles 1x1 "${frames[@]}" --budget-rays 24000 --save-states twice.json
sim four --tiles 2x2 "${frames[@]}" --budget-rays 24000 --save-states four.json
is "one tile holds the band" "$(band one 24000)" "0 True True"
is "four tiles hold the band" "$(band four 24000)" "0 True True"
same_file "equal runs decide alike" twice.json one.json
is "the strain is in the states" "$(python3 -c "
import json
print(max(json.loads(line)['strain'] for line in list(open('one.json'))[1:]) > 1.5)")" True
is "the error that is paid is told" "$(json one/report.json '["predicted_error"]["worst"] > 1.2')" True
is "with the knobs in force" "$(json one/report.json '["predicted_error"]["in_force"]["gaze_margin"] < 3')" True
is "and the budget" "$(json one/report.json '["predicted_error"]["budget"]["rays"]')" 24000.0

sim again --tiles 3x1 --states one.json
for frame in 0000 0003 0023; do
    same_file "frame $frame, repeated on other tiles" again/wall-$frame.png one/wall-$frame.png
done
is "nothing was decided anew" "$(cut -d, -f17 again/frames.csv)" "$(cut -d, -f17 one/frames.csv)"

# Full quality when nobody's gaze is known, whatever the budget.
sim blind --tiles 2x1 --no-gaze --frames 4 --budget-rays 24000
"$program" render "${common[@]}" --no-gaze --out blind.png --report blind.json
is "no gaze, full quality" "$(json blind/report.json '["image"]["hash"]')" "$(json blind.json '["image"]["hash"]')"

is "where nothing was looked at, neither the worst nor the mean error is below one" \
    "$(python3 -c "import csv
print({(row['error_worst'], row['error_mean']) for row in csv.DictReader(open('blind/frames.csv'))})")" "{('1', '1')}"

sim time --tiles 1x1 --frames 6 --budget 0.1
is "a budget of time that cannot be held strains all it can" "$(json time/report.json '["predicted_error"]["in_force"]["strain"]')" 16.0

expect "two budgets" 2 "leave out one" sim --budget 10 --budget-rays 10
expect "a budget and states" 2 "--states holds what a budget decided" sim --budget 10 --states one.json
expect "render has no frames to hold it over" 2 "--set strain=Q" render --budget 10
expect "no budget of nothing" 2 "--budget" sim --budget 0
finish
