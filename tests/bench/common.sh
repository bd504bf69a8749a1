# Read by tests/bench/run: the group common. Not run by itself.
# shellcheck shell=bash

# Seven frames along the path at each budget, at full resolution and by one filter. The hospital's corridors at the smaller one.
common_captures() { # NAME LABEL BUDGET_MS PATH_ARGUMENTS...
  local name=$1 label=$2 budget=$3 frame
  shift 3
  captures=()
  for frame in 60 150 240 330 420 500 580; do
    captures+=("$work/common-$label-$budget-$frame.cap")
    measure "common walk $label $budget $frame" "$surefoot" walk "$work/$name.walk" "$@" --clock virtual --backend null --resolution 100 --filter bilinear \
      --rest-after 0 --hysteresis 1 --state "$work/no-table" --budget "$budget" --frames $((frame + 1)) --capture "${captures[-1]}" \
      --capture-frame "$frame" --json || return 1
  done
}

common_figure() { # LABEL BUDGET_MS
  measure "common $1 $2" "$build/tests/bench_common_error" "${captures[@]}" || return 0
  keep common_error "$(percent min_of_best)" --scene "$1, $2 ms" \
    --note "Accuracy $(rounded to_two_stage) times that of two-stage, $(rounded to_threshold) times that of threshold (medians); of $(value captures) frames $(value exact) are exact and left out."
}

common_scene() { # NAME
  local budget captures
  path_of "$1"
  for budget in 26.7 13; do
    common_captures "$1" "$1" "$budget" "${path[@]}" && common_figure "$1" "$budget"
  done
  [[ $1 == hospital ]] || return 0
  common_captures hospital corridors 13 --path "$top/tests/bench/paths/hospital-corridors.csv" && common_figure corridors 13
}
