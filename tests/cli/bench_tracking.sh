#!/bin/bash
# gazewall bench tracking: the table in all three forms, and what it must show.
# shellcheck source=tests/support/tap.sh
. "$(dirname "$0")/../support/tap.sh"
expect "bench tracking" 0 "head_filter=kalman" bench tracking --quick --out "$folder/bench"
exists "its rows" "$folder/bench/tracking.csv"
is "prediction, filters and saccades do what they are for" "$(python3 - "$folder/bench/tracking.json" <<'P'
import json, sys
bench = json.load(open(sys.argv[1]))["bench"]
head = [r for r in bench["rows"] if r["table"] == "head"]
gaze = [r for r in bench["rows"] if r["table"] == "gaze"]
one = [r for r in head if r["filter"] == "head_filter=one-euro"]
none = {(r["rate_hz"], r["noise"]): r for r in head if r["filter"] == "head_filter=none"}
print(len(head), len(gaze),
      all(r["predicted_error_mm"] < r["error_mm"] / 2 for r in head if "growth=0" not in r["filter"] and r["noise"] < 0.5),
      all(r["jitter_mm"] < none[r["rate_hz"], r["noise"]]["jitter_mm"] / 2 and r["lag_ms"] > 1 for r in one),
      all(r["saccades_missed"] <= 1 and r["saccades_false"] <= 1 for r in gaze
          if r["noise"] < 0.3 and "saccade_speed" not in r["filter"]),
      all(0 < v < 5 for v in bench["cost_us"].values()))
P
)" "24 16 True True True True"
expect "it takes no scene" 2 "leave --scene out" bench tracking --scene a.obj
finish
