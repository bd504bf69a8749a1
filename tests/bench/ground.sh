# Read by tests/bench/run: the group ground. Not run by itself.
# shellcheck shell=bash

# How long the walker's question takes, and what making its ground adds to a bake.
ground_scene() { # NAME INPUT
  if measure "ground $1" "$build/tests/bench_ground_query" "$work/$1.walk"; then
    keep ground_query_p99_us "$(rounded step_us.p99)" --scene "$1" --note "$(rounded step_us.p50) us in the middle, at most $(rounded step_us.max); clipping a region $(rounded clip_us.p99) us, on another thread; $(rounded walked_m) m walked."
  fi
  measure "ground bake $1" "$build/tests/bench_ground_bake" "$2" || return 0
  keep ground_bake_s "$(sum "($(value ground_s) + $(value tour_s)) * 1e6 / $(value triangles)" 3)" --scene "$1" \
    --note "ground $(value ground_s) s, default path $(value tour_s) s, for $(value triangles) triangles; $(value bytes) bytes."
}

# Five pairs of walks steered by one recording on the real clock, on foot and in flight: how old reports are when frames show them.
ground_latency() { # NAME
  local turn mode foot=() flight=()
  "$build/tests/bench_gamepad_recording" >"$work/gamepad.hid"
  for turn in 1 2 3 4 5; do
    for mode in walk fly; do
      measure "latency $1 $mode $turn" "$surefoot" walk "$work/$1.walk" --input "$work/gamepad.hid" --walking "$mode" --backend null --state "$state" --json || return 0
      if [[ $mode == walk ]]; then foot+=("$(value input.age_ms.p99)"); else flight+=("$(value input.age_ms.p99)"); fi
    done
  done
  keep ground_latency_ms "$(sum "$(middle_of "${foot[@]}") - $(middle_of "${flight[@]}")" 3)" --scene "$1" \
    --note "99 of 100 on foot ${foot[*]}, in flight ${flight[*]} ms."
}
