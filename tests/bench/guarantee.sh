# Read by tests/bench/run: the group guarantee. Not run by itself.
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
