# The group `full OLD NEW` of tests/bench/run, which sources this: whether two builds show the same full detail. Both bake for themselves, and
# draw 24 poses of each scene's path on the virtual clock without a budget. The worst pose counts. Scenes are those of picture.sh.
# shellcheck shell=bash
# shellcheck disable=SC2034,SC2154 # work, build, old, new, failed: of run

full_poses=24

# The pictures of NAME's poses by BUILD, in WORK/full/NAME-SIDE.
full_side() { # BUILD SIDE NAME SCENE
  local at=$work/full
  rm -rf "$at/$3-$2" "$at/$3-$2.walk"
  measure "full bake $2 $3" "$1/surefoot" bake "$4" -o "$at/$3-$2.walk" --state "$at/state" --json || return 1
  # Four frames at each pose, for the prepared region to follow; every fourth is a picture.
  measure "full walk $2 $3" "$1/surefoot" walk "$at/$3-$2.walk" --path "$at/$3.poses.csv" --selector flat --clock virtual --cost-scale 0.01 \
    --no-check --no-occlusion --rate 30 --frames $((4 * full_poses)) --state "$at/state" --snap "$at/$3-$2" --every 4 --json
}

full_scene() { # NAME SCENE PATH LIFT
  local at=$work/full
  full_path "$@" || { failed=1; return 0; }
  full_side "$old" old "$1" "$2" || { failed=1; return 0; }
  full_side "$new" new "$1" "$2" || { failed=1; return 0; }
  measure "full difference $1" "$build/tests/bench_picture_difference" "$at/$1-new" "$at/$1-old" || { failed=1; return 0; }
  if (( $(value pictures) != full_poses )); then
    echo "tests/bench/run: $1: $(value pictures) pictures are there, not $full_poses" >&2
    failed=1
    return 0
  fi
  keep full_detail_same "$(value worst_within_1_percent)" --scene "$1" \
    --note "Mean of $(value pictures) poses: $(value within_1_percent) %, $(value psnr_db) dB; the worst: $(value least_alike)."
  echo "tests/bench/run: $1: $(value worst_within_1_percent) % of the worst pose within 1/255 ($at/$1-new/$(value least_alike) and $1-old)" >&2
}

# Poses spread over the path. A ledger names them; its walk draws nothing.
full_path() { # NAME SCENE PATH LIFT
  local at=$work/full every=20
  measure "full bake poses $1" "$new/surefoot" bake "$2" -o "$at/$1-new.walk" --state "$at/state" --json || return 1
  measure "full ledger $1" "$new/surefoot" walk "$at/$1-new.walk" --path "$3" --lift "$4" --clock virtual --backend null --rate 10 \
    --frames $((every * full_poses)) --state "$at/state" --ledger "$at/$1.ledger.csv" --json || return 1
  measure "full poses $1" "$build/tests/bench_ledger_poses" "$3" "$4" 10 "$at/$1.ledger.csv" "$every" "$at/$1.poses.csv"
}

full_group() {
  local program picture_work=$work/picture
  for program in "$old/surefoot" "$new/surefoot" "$build/tests/bench_ledger_poses" "$build/tests/bench_picture_difference"; do
    [[ -x "$program" ]] || { echo "tests/bench/run: $program is not there: build it (the target benches has those of tests)" >&2; failed=1; return 0; }
  done
  mkdir -p "$picture_work" "$work/full/state"
  each_scene full full_scene
}
