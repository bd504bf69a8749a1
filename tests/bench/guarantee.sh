# Read by tests/bench/run: the groups guarantee and points. Not run by itself.
# shellcheck shell=bash

# 600 frames of a tour with a guaranteed accuracy, and four of them captured: is all that the records say true?
guarantee_walk() { # NAME BUDGET_MS ACCURACY PATH_ARGUMENTS...
  local name=$1 budget=$2 accuracy=$3 label=guarantee-$1-$2-$3 frame captures=() walk=()
  shift 3
  walk=("$surefoot" walk "$work/$name.walk" "$@" --clock virtual --backend null --resolution 100 --filter bilinear --rest-after 0
    --state "$work/no-table" --budget "$budget" --min-accuracy "$accuracy" --json)
  measure "$label" "${walk[@]}" --frames 600 --ledger "$work/$label.csv" || return 0
  for frame in 60 240 420 580; do
    captures+=("$work/$label-$frame.cap")
    measure "$label-$frame" "${walk[@]}" --frames $((frame + 1)) --capture "${captures[-1]}" --capture-frame "$frame" || return 0
  done
  measure "$label-judged" "$build/tests/bench_guarantee" "$accuracy" "$work/$name.walk" "$work/$label.csv" "${captures[@]}" || return 0
  keep guarantee_true "$(sum "100 * ($(value frames) + $(value captures) - $(value untrue)) / ($(value frames) + $(value captures))" 5)" \
    --scene "$name, $accuracy rad^-1, $budget ms" \
    --note "Kept in $(value kept) of $(value frames) frames, over the budget in $(value over_budget); smallest accuracy reached: $(value min_reached) rad^-1."
}

guarantee_scene() { # NAME BUDGET_MS ACCURACY...
  local name=$1 budget=$2 accuracy
  shift 2
  path_of "$name"
  for accuracy in "$@"; do guarantee_walk "$name" "$budget" "$accuracy" "${path[@]}"; done
}

# 100 000 points of the true surface in three frames of `curve-accuracy` at 400 rad^-1: is each of them drawn within that?
points_scene() { # NAME
  local name=$1 label=points-$1 frame captures=() walk=()
  path_of "$name"
  walk=("$surefoot" walk "$work/$name.walk" "${path[@]}" --clock virtual --backend null --resolution 100 --filter bilinear --rest-after 0
    --cost-scale 0.01 --no-check --state "$work/no-table" --selector curve-accuracy --accuracy 400 --json)  # no slice is drawn as its stand-in
  measure "$label" "${walk[@]}" --frames 600 --ledger "$work/$label.csv" || return 1
  local reached
  reached=$(value accuracy.min) || return 1
  for frame in 60 300 580; do
    captures+=("$work/$label-$frame.cap")
    measure "$label-$frame" "${walk[@]}" --frames $((frame + 1)) --capture "${captures[-1]}" --capture-frame "$frame" || return 1
  done
  measure "$label-judged" "$build/tests/bench_surface_points" 400 100000 "$work/$name.walk" "$work/$label.csv" "${captures[@]}" || return 1
  if (( $(value points) < 100000 )); then echo "tests/bench/run: $name: only $(value points) points are in view" >&2; failed=1; return 1; fi
  keep points_beyond "$(value beyond)" --scene "$name" \
    --note "$(value points) points on $(value forms) coarse forms; the worst is seen at $(value worst_accuracy) rad^-1. The least of 600 records: $(sum "$reached" 4)."
}
