#!/bin/bash
# gazewall bench tracking: the table in all three forms, and what it must show.
# shellcheck source=tests/support/tap.sh
. "$(dirname "$0")/../support/tap.sh"
expect "bench tracking" 0 "head_filter=kalman" bench tracking --quick --out "$folder/bench"
exists "its rows" "$folder/bench/tracking.csv"
is "prediction, filters and saccades do what they are for" "$(python3 - "$folder/bench/tracking.json" <<'P'
import json, sys
bench = json.load(open(sys.argv[1]))["bench"]
shipped = [r for r in bench["rows"] if r["track"]]
head = [r for r in bench["rows"] if r["table"] == "head" and not r["track"]]
gaze = [r for r in bench["rows"] if r["table"] == "gaze" and not r["track"]]
of = lambda track, name: next(r for r in shipped if r["track"] == track and r["filter"] == name)
one = [r for r in head if r["filter"] == "head_filter=one-euro"]
none = {(r["rate_hz"], r["noise"]): r for r in head if r["filter"] == "head_filter=none"}
print(len(head), len(gaze),
      all(r["predicted_error_mm"] < r["error_mm"] / 2 for r in head if "growth=0" not in r["filter"] and r["noise"] < 0.5),
      all(r["jitter_mm"] < none[r["rate_hz"], r["noise"]]["jitter_mm"] / 2 and r["lag_ms"] > 1 for r in one),
      all(r["saccades_missed"] <= 1 and r["saccades_false"] <= 1 for r in gaze
          if r["noise"] < 0.3 and "saccade_speed" not in r["filter"]),
      all(r["saccades_missed"] <= 2 for r in gaze if "saccade_speed" not in r["filter"]),
      len(shipped), of("walking", "head_filter=none")["predicted_error_mm"] < of("walking", "head_filter=none")["error_mm"] / 3,
      5 < of("walking", "head_filter=none")["lag_ms"] < 8, # the line's, which every packet takes
      of("standing", "head_filter=one-euro")["jitter_mm"] < of("standing", "head_filter=none")["jitter_mm"] / 2,
      of("saccades", "gaze_filter=one-euro")["saccades_missed"] + of("saccades", "gaze_filter=one-euro")["saccades_false"] == 0,
      of("pursuit", "gaze_filter=none gaze_prediction=on")["ahead_error_deg"] < 0.6 * of("pursuit", "gaze_filter=none")["ahead_error_deg"],
      all(0 < v < 5 for v in bench["cost_us"].values()))
P
)" "24 20 True True True True 33 True True True True True True"
expect "it takes no scene" 2 "leave --scene out" bench tracking --scene a.obj
finish
