# The group `replay OLD NEW` of tests/bench/run, which sources this: captures that an older build recorded, selected from again by both.
# Every selector that OLD has must make the same cut in NEW. Frames are of the virtual clock and the null backend, so nothing is timed.
# shellcheck shell=bash
# shellcheck disable=SC2034,SC2154 # work, top, data, old, new, failed, values: of run

replay_captures=7 replay_every=60  # frames
replay_budgets=(24 12 6)           # ms, in turns, so that selectors do not all reach full detail

# NAME INPUT PATH LIFT, a line a scene. Generated scenes are made by OLD.
replay_sources() {
  local name
  for name in forest town; do echo "$name $replay_work/$name.glb $replay_work/$name.path.csv 0"; done
  [[ -d "$data" ]] || return 0
  echo "hospital $data/interior/hospital/hospital_three_floors.glb $top/tests/bench/paths/hospital-tour.csv 0"
  echo "candela $data/outdoor/candela-city/candela_city.glb $data/outdoor/candela-city/recorded_path.csv 1.5"
}

# Bakes NAME by OLD and records its captures, unless that is done.
replay_record() { # NAME INPUT PATH LIFT
  local at=$replay_work/$1 i scale=1
  [[ $1 != forest ]] || scale=10
  case $1 in forest | town) [[ -f "$2" && -f "$3" ]] || "$old/surefoot" scene "$1" --scale "$scale" --seed 1 -o "$2" >&2 || return 1 ;; esac
  [[ -f "$at.walk" ]] || measure "replay bake $1" "$old/surefoot" bake "$2" -o "$at.walk" --state "$replay_work/state" --json || return 1
  for (( i = 0; i < replay_captures; ++i )); do
    [[ ! -f "$at-$i.cap" ]] || continue
    measure "replay walk $1 $i" "$old/surefoot" walk "$at.walk" --path "$3" --lift "$4" --state "$replay_work/state" --clock virtual \
      --backend null --budget "${replay_budgets[i % ${#replay_budgets[@]}]}" --frames $((replay_every * (i + 1))) \
      --capture "$at-$i.cap" --capture-frame $((replay_every * (i + 1) - 1)) --json || return 1
  done
}

# The cuts of a capture by every selector of OLD, a line each: selector, hash, items. The first is the captured one's.
replay_cuts() { # LABEL BUILD CAPTURE
  local selector arguments=() i
  for selector in "${replay_selectors[@]}"; do arguments+=(--selector "$selector"); done
  measure "replay cuts $1" "$2/surefoot" replay "$3" "${arguments[@]}" --json || return 1
  for (( i = 0; i < ${values[cuts]:-0}; ++i )); do
    echo "${values[cuts.$i.selector]} ${values[cuts.$i.hash]} ${values[cuts.$i.items]}"
  done
}

replay_scene() { # NAME INPUT PATH LIFT
  local i capture before after compared=0 differing=0 distinct=0
  replay_record "$@" || { failed=1; return 0; }
  for (( i = 0; i < replay_captures; ++i )); do
    capture=$replay_work/$1-$i.cap
    before=$(replay_cuts "$1 $i old" "$old" "$capture") || { failed=1; return 0; }
    # A capture that NEW refuses has no cuts: all of them differ.
    after=$(replay_cuts "$1 $i new" "$new" "$capture" || true)
    compared=$((compared + $(wc -l <<<"$before")))
    differing=$((differing + $(diff <(echo "$before") <(echo "$after") | grep -c '^<' || true)))
    distinct=$((distinct + $(cut -d' ' -f2 <<<"$before" | sort -u | wc -l)))
  done
  keep replay_differs "$differing" --scene "$1" --note "$compared cuts of $replay_captures captures, $distinct of them distinct."
}

replay_group() {
  local program name input path lift chosen=" ${chosen_scenes[*]} "
  for program in "$old/surefoot" "$new/surefoot"; do
    [[ -x "$program" ]] || { echo "tests/bench/run: $program is not there: build it" >&2; failed=1; return 0; }
  done
  local replay_work replay_selectors
  replay_work=$work/replay-$(sha256sum "$old/surefoot" | cut -c 1-12)
  mkdir -p "$replay_work"
  read -ra replay_selectors < <("$old/surefoot" replay --help | sed -n 's/^ *--selector TEXT:\(.*\) \.\.\.$/\1/p' | tr -d ',')
  if (( ${#replay_selectors[@]} == 0 )); then echo "tests/bench/run: replay: $old/surefoot names no selectors" >&2; failed=1; return 0; fi
  if [[ ! -f "$replay_work/state/costs.toml" ]]; then
    measure "replay calibrate" "$old/surefoot" calibrate --state "$replay_work/state" --json || { failed=1; return 0; }
  fi
  while read -r name input path lift <&3; do
    [[ $chosen != "  " && $chosen != *" $name "* ]] || replay_scene "$name" "$input" "$path" "$lift"
  done 3< <(replay_sources)
}
