# The group `bakes OLD NEW` of tests/bench/run, which sources this: what the forms of a newer build cost beside an older one, in turns.
# A bake's time, the file's size, and a walk's memory and its time from the start to the end of its second frame. Both builds use their
# built-in cost tables. Walks are on the virtual clock, where none waits for a period.
# Scenes are those of picture.sh.
# shellcheck shell=bash
# shellcheck disable=SC2034,SC2154 # work, data, old, new, failed, chosen_scenes: of run

bakes_turns=3

# bakes_side BUILD NAME SCENE PATH LIFT: sets bake_s, file_mb, walk_mib and opening_s.
bakes_side() {
  local walk=$work/bakes/$2.walk took
  rm -f "$walk"
  measure "bakes bake $2" "$1/surefoot" bake "$3" -o "$walk" --state "$work/bakes/state" --json || return 1
  bake_s=$(value seconds) || return 1
  bake_triangles=$(value triangles) || return 1
  if [[ ! -s "$walk" ]]; then echo "tests/bench/run: $1/surefoot wrote no $walk" >&2; return 1; fi
  file_mb=$(awk "BEGIN { print $(stat -c %s "$walk") / 1e6 }")
  # The first walk warms the system's cache of files; the second counts.
  for _ in 1 2; do
    if ! /usr/bin/time -o "$work/bakes/time" -f '%e %M' "$1/surefoot" walk "$walk" --path "$4" --lift "$5" --frames 2 --clock virtual \
      --state "$work/bakes/state" --json >"$work/raw/bakes-walk-$2.json" 2>"$work/raw/bakes-walk-$2.log"; then
      echo "tests/bench/run: a walk of $2 by $1 failed: $(tail -n 1 "$work/raw/bakes-walk-$2.log")" >&2
      return 1
    fi
  done
  took=$(tail -n 1 "$work/bakes/time")
  opening_s=${took% *} walk_mib=$(awk "BEGIN { print ${took#* } / 1024 }")
}

# kept_ratio PROMISE NAME UNIT NEW OLD: the median over the turns of NEW / OLD. NEW, OLD: a figure a turn.
kept_ratio() {
  local more less i ratios=()
  read -ra more <<<"$4"
  read -ra less <<<"$5"
  for i in "${!more[@]}"; do ratios+=("$(awk "BEGIN { printf \"%.3f\", ${more[i]} / ${less[i]} }")"); done
  keep "$1" "$(middle_of "${ratios[@]}")" --scene "$2" --spread "$(min_and_max "${ratios[@]}")" \
    --note "$(rounded_all "$4") $3; the older build $(rounded_all "$5") $3.${6:+ $6}"
}
rounded_all() { awk -v all="$1" 'BEGIN { n = split(all, x, " "); for (i = 1; i <= n; ++i) printf "%s%.3g", (i > 1 ? ", " : ""), x[i] }'; }

bakes_scene() { # NAME SCENE PATH LIFT
  local turn side label bake_s bake_triangles file_mb walk_mib opening_s
  local -A bakes=() files=() memory=() opening=()
  for (( turn = 1; turn <= bakes_turns; ++turn )); do
    for label in old new; do
      side=$new
      [[ $label != old ]] || side=$old
      bakes_side "$side" "$@" || { failed=1; return 0; }
      bakes[$label]+=" $bake_s" files[$label]+=" $file_mb" memory[$label]+=" $walk_mib" opening[$label]+=" $opening_s"
    done
  done
  kept_ratio forms_bake "$1" s "${bakes[new]}" "${bakes[old]}" "$(awk "BEGIN { printf \"%.3g\", $bake_s * 1e6 / $bake_triangles }") s a million triangles."
  kept_ratio forms_file "$1" MB "${files[new]}" "${files[old]}"
  kept_ratio forms_memory "$1" MiB "${memory[new]}" "${memory[old]}"
  kept_ratio forms_opening "$1" s "${opening[new]}" "${opening[old]}"
}

bakes_group() {
  local program
  for program in "$old/surefoot" "$new/surefoot"; do
    [[ -x "$program" ]] || { echo "tests/bench/run: $program is not there: build it" >&2; failed=1; return 0; }
  done
  [[ -x /usr/bin/time ]] || { echo "tests/bench/run: /usr/bin/time is not installed (Debian: time)" >&2; failed=1; return 0; }
  local picture_work=$work/picture
  mkdir -p "$picture_work" "$work/bakes/state"
  each_scene bakes bakes_scene
}
