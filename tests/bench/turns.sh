# The group `turns` of tests/bench/run, which sources this: sudden turns in the drives of two scenes.
# shellcheck shell=bash
# shellcheck disable=SC2154 # work, build, state, path: of run

turns_scene() { # NAME
  local clock scene
  fit "$1"
  path_of "$1"
  for clock in virtual real; do
    scene=$1; [[ $clock == virtual ]] || scene="$1, real clock"
    measure "turns $1 $clock" "$build/tests/bench_turns" "$work/$1.walk" "${path[1]:-}" "${path[3]:-0}" "$state" "$clock" || continue
    keep turn_floor_frames "$(value floor_frames)" --scene "$scene" --note "$(value turns) turns in $(value frames) frames, $(value misses) missed."
    keep turn_drop_db "$(rounded drop_db.max 3)" --scene "$scene" \
      --note "$(value over_6_db) of $(value turn_frames) frames over 6 dB, $(value over_6_db_still) of them without the turn too; $(value over_6_db_of_any_psnr), if PSNR counts above 40 dB."
  done
}
