# The groups `cache` and `speeds` of tests/bench/run, which sources this: the image cache beside a load, and what it saves by speed.
# shellcheck shell=bash
# shellcheck disable=SC2034,SC2154 # work, surefoot, state, path, build, bench, failed: of run

cache_rate=30

# The town's own path, run along with turns and jumps: 60 s. A walk goes it forth and back.
running_path() {
  "$build/tests/bench_running_path" "$work/town.path.csv" >"$work/town-running.csv" || { failed=1; return 1; }
}

# cache_walk LABEL KEEPS: the deadline rule of a walk beside a load, and how long pictures took. SUREFOOT_CACHE_PAIRS shortens it, to see that
# it runs: no figure of it is kept then.
cache_walk() { # LABEL KEEPS
  local label=$1 keeps=$2 pairs=${SUREFOOT_CACHE_PAIRS:-} status=0 scene="town, running, $2" of=(--command "tests/bench/run cache")
  load 500 "cache $keeps" || return 0
  measure "cache $label" "$surefoot" walk "$work/town.walk" --path "$work/town-running.csv" --cache="$keeps" --rate "$cache_rate" \
    --control ${pairs:+--control-pairs "$pairs"} --state "$state" --ledger "$work/cache-$label.csv" --json || status=1
  unload
  (( status == 0 )) || return 0
  if [[ -z "$pairs" ]]; then
    judged cache "$scene" "" "${of[@]}"
    keep cache_load "$(percent control.other_miss_share 3)" --scene "$scene" "${of[@]}"
  fi
  measure "refreshes $label" awk -v period_ms="$(awk "BEGIN { print 1000 / $cache_rate }")" -f "$bench/refreshes.awk" "$work/cache-$label.csv" || return 0
  echo "tests/bench/run: $scene: $(cat "$work/raw/refreshes-$label.json")" >&2
  [[ -z "$pairs" ]] || return 0
  keep cache_refresh_p99 "$(percent p99_of_period)" --scene "$scene" "${of[@]}" --note "$(value pictures_made) pictures in $(value frames) frames with $(value jumps) jumps."
  keep cache_refresh_max "$(percent max_after_jumps_of_budget)" --scene "$scene" "${of[@]}" \
    --note "In $(value frames_after_jumps) frames within two seconds of a jump, $(value own_misses_after_jumps) of them missed by the walk itself."
}

cache_group() {
  [[ -n "${SUREFOOT_CACHE_PAIRS:-}" ]] || fit town
  running_path || return 0
  for keeps in view surround; do cache_walk "$keeps" "$keeps"; done
}

# CPU time of frames with pictures, over that without, by the speed of the eye. WORK/cache-speeds.svg is the chart.
speeds_group() { # NAME...
  local name speed frames=${SUREFOOT_SPEED_FRAMES:-150} points=$work/cache-speeds.csv
  echo "# scene,speed_m_s,ratio" >"$points"
  for name in "$@"; do
    baked "$name" || continue
    path_of "$name"
    for speed in 0.35 0.7 1.4 2.8 5.6; do
      measure "speeds $name $speed" "$build/tests/bench_picture_cache" "$work/$name.walk" "${path[1]:-}" "$frames" flat "" "$state" \
        "${path[3]:-0}" "$speed" || continue
      echo "$name,$speed,$(sum "$(value cpu_ms) / $(value cpu_ms_without)")" >>"$points"
      [[ -z "${SUREFOOT_SPEED_FRAMES:-}" ]] || continue
      keep cache_cpu_ratio "$(sum "$(value cpu_ms) / $(value cpu_ms_without)")" --scene "$name, $speed m/s" \
        --note "$(value cpu_ms) of $(value cpu_ms_without) ms a frame; $(value made) new pictures a frame."
    done
  done
  awk -f "$bench/speed_chart.awk" "$points" >"$work/cache-speeds.svg" || failed=1
  echo "tests/bench/run: the chart is $work/cache-speeds.svg" >&2
}
