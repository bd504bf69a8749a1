# Read by tests/bench/run: the group common. Not run by itself.
# shellcheck shell=bash

# Seven frames along a path, at full resolution and by one filter, are added to the array `captures`.
common_captures() { # NAME LABEL BUDGET_MS PATH_ARGUMENTS...
  local name=$1 label=$2 budget=$3 frame
  shift 3
  for frame in 60 150 240 330 420 500 580; do
    captures+=("$work/common-$label-$budget-$frame.cap")
    measure "common walk $label $budget $frame" "$surefoot" walk "$work/$name.walk" "$@" --clock virtual --backend null --resolution 100 \
      --filter bilinear --rest-after 0 --hysteresis 1 --state "$work/no-table" --budget "$budget" --frames $((frame + 1)) \
      --capture "${captures[-1]}" --capture-frame "$frame" --json || return 1
  done
}

common_figure() { # LABEL
  measure "common $1" "$build/tests/bench_common_error" "${captures[@]}" || return 0
  keep common_error "$(percent min_of_best)" --scene "$1" \
    --note "Accuracy $(rounded to_two_stage) times that of two-stage, $(rounded to_threshold) times that of threshold (medians); of $(value captures) frames $(value exact) show full detail and are left out."
}

common_scene() { # NAME
  local captures=()
  path_of "$1"
  common_captures "$1" "$1" 26.7 "${path[@]}" && common_captures "$1" "$1" 13 "${path[@]}" && common_figure "$1"
  [[ $1 == hospital ]] || return 0
  captures=()
  common_captures hospital corridors 13 --path "$top/tests/bench/paths/hospital-corridors.csv" && common_figure corridors
}
