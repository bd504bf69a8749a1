# The groups `cache` and `pays` of tests/bench/run, which sources this: the image cache beside a load, and where it saves time.
# shellcheck shell=bash
# shellcheck disable=SC2034,SC2154 # work, surefoot, state, top, build, bench, failed: of run

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
    judged deadline "$scene" "" "${of[@]}"
    keep deadline_load "$(percent control.other_miss_share 3)" --scene "$scene" "${of[@]}"
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

# ---- where it pays: CPU time of frames with pictures over that without, by speed, overdraw and size ----

# pays_point PANEL LINE SCENE MODEL SELECTOR SPEED SIZE X: measures a point, and appends it to the points. X is the name of a value that the
# bench prints. SCENE is the name of the figure. pays_at says which part of the path counts.
pays_point() {
  local panel=$1 line=$2 scene=$3 model=$4 selector=$5 speed=$6 size=$7 at=$8 ratio spread ms
  (( ++pays_done ))
  measure "pays $model $pays_at $selector $speed $size" "$build/tests/bench_picture_cache" "$work/$model.walk" "$pays_path" "$pays_frames" "$selector" "" \
    "$state" 0 "$speed" view "$size" "$pays_warm_up" "$pays_at" || return 0
  at=$(value "$at") || { failed=1; return 0; }
  [[ $panel != size ]] || at=$(sum "$at / 1000")
  ratio=$(value ratio) spread="$(value ratio_least) to $(value ratio_greatest)" ms="$(value cpu_ms) of $(value cpu_ms_without) ms"
  echo "$panel,$line,$at,$ratio,$(value ratio_least),$(value ratio_greatest),$(value cpu_ms),$(value cpu_ms_without),$(value pictures),$(value made)" \
    >>"$pays_points"
  echo "tests/bench/run: $pays_done of $pays_all: $scene: $ratio ($spread), $ms a frame, x $at, $(value worst_db) dB" >&2
  [[ -z "${SUREFOOT_PAYS_FRAMES:-}" ]] || return 0
  keep cache_pays "$(sum "$ratio" 3)" --scene "$scene" --spread "$spread" \
    --note "$ms a frame; $(value made) new pictures a frame; overdraw $(value overdraw), written $(value overdraw_written)."
  if [[ $line == "from the edge: flat" && $speed != 11 ]]; then
    keep cache_cpu_ratio "$(sum "$ratio" 3)" --scene "${scene%, flat}" --spread "$spread" --note "$ms a frame; $(value made) new pictures a frame."
  fi
}

# pays_bake NAME COMMAND...: makes NAME.glb by a command and bakes it, unless that is there.
pays_bake() {
  local name=$1
  shift
  [[ ! -f "$work/$name.walk" ]] || return 0
  echo "tests/bench/run: baking $name" >&2
  if "$@" >&2 && "$surefoot" bake "$work/$name.glb" -o "$work/$name.walk" --state "$state" >"$work/raw/bake-$name.log" 2>&1; then return 0; fi
  failed=1
  echo "tests/bench/run: $name could not be made or baked: see $work/raw/bake-$name.log" >&2
  return 1
}

# A quick table has no masked pixels, so it needs a whole one. The forest has 100 trees a unit of its scale, and its side grows with them.
# The wall has the same extent with any number of layers.
pays_scenes() {
  local scale surface layers
  for scale in 1 3 10; do
    pays_bake "$(pays_forest "$scale")" "$surefoot" scene forest --scale "$scale" --seed 1 -o "$work/$(pays_forest "$scale").glb" || return 1
  done
  for surface in masked opaque; do
    for layers in 1 2 4 8; do
      pays_bake "wall-$surface-$layers" "$build/tests/bench_layered_wall" "$layers" "$surface" "$work/wall-$surface-$layers.glb" || return 1
    done
  done
  [[ -f "$state/costs.toml" ]] || echo "tests/bench/run: calibrating" >&2
  [[ -f "$state/costs.toml" ]] || "$surefoot" calibrate --state "$state" >"$work/raw/pays-calibrate.log" 2>&1 || { failed=1; return 1; }
}
pays_forest() { if (( $1 == 10 )); then echo forest; else echo "forest-$1"; fi; }

pays_speeds() {
  local speed selector
  for speed in 0.35 0.7 1.4 2.8 5.6 11; do
    for selector in flat curve-accuracy; do
      pays_point speed "from the edge: $selector" "forest, $speed m/s, $selector" forest "$selector" "$speed" 1280x720 moved_m_s
    done
    pays_at=0.5 pays_point speed "inside: flat" "forest, inside, $speed m/s, flat" forest flat "$speed" 1280x720 moved_m_s
    [[ ! -f "$work/hospital.walk" ]] || pays_path="$top/tests/bench/paths/hospital-tour.csv" \
      pays_point speed "hospital from outside: flat" "hospital, $speed m/s, flat" hospital flat "$speed" 1280x720 moved_m_s
  done
}

pays_overdraw() {
  local surface layers selector
  for surface in masked opaque; do
    for layers in 1 2 4 8; do
      for selector in flat curve-accuracy; do
        pays_at=0.5 pays_point overdraw "$surface: $selector" "wall, $surface, layers: $layers, $selector" "wall-$surface-$layers" "$selector" \
          1.4 1280x720 overdraw
      done
    done
  done
}

pays_sizes() {
  local scale size
  for scale in 1 3 10; do
    for size in 640x360 1280x720 1920x1080; do
      pays_point size "$size: flat" "forest, trees: ${scale}00, $size, flat" "$(pays_forest "$scale")" flat 1.4 "$size" triangles_without
    done
    pays_point size "1280x720: curve-accuracy" "forest, trees: ${scale}00, 1280x720, curve-accuracy" "$(pays_forest "$scale")" \
      curve-accuracy 1.4 1280x720 triangles_without
  done
}

# The chart and its points go beside the page, unless SUREFOOT_PAYS_FRAMES shortens the run to see that it works, or SUREFOOT_PAYS_PANELS
# names a part of the panels; then they stay in WORK.
pays_group() {
  local pays_frames=${SUREFOOT_PAYS_FRAMES:-30} pays_warm_up=72
  local panel panels=${SUREFOOT_PAYS_PANELS:-speeds overdraw sizes}
  local pays_points=$work/pays.csv pays_path="" pays_at=0.05 pays_done=0 pays_all=46 to=$work
  [[ -z "${SUREFOOT_PAYS_FRAMES:-}" ]] || pays_warm_up=$pays_frames
  [[ ! -f "$work/hospital.walk" ]] || pays_all=52
  pays_scenes || return 0
  echo "# panel,line,x,ratio,least,greatest,cpu_ms,cpu_ms_without,pictures,made" >"$pays_points"
  for panel in $panels; do
    case $panel in speeds | overdraw | sizes) "pays_$panel" ;; *) wrong_use "SUREFOOT_PAYS_PANELS: there is no $panel" ;; esac
  done
  LC_ALL=C awk -f "$bench/svg.awk" -f "$bench/pays.awk" -v to="$work/pays.svg" "$pays_points" >"$work/pays.md" || { failed=1; return 0; }
  cat "$work/pays.md" >&2
  if [[ -z "${SUREFOOT_PAYS_FRAMES:-}${SUREFOOT_PAYS_PANELS:-}" ]] && (( failed == 0 )); then to=$top/render/cache; cp "$work/pays.svg" "$pays_points" "$to"; fi
  echo "tests/bench/run: the chart is $to/pays.svg, its points are in $to/pays.csv" >&2
}
