# The group `switches` of tests/bench/run, which sources this: late frames of a tour by night while its light is switched, beside a load.
# shellcheck shell=bash
# shellcheck disable=SC2034,SC2154 # work, surefoot, state, build, bench, failed: of run

# Button 3 of the recorded gamepad starts the tour. Buttons 5 to 8 switch the light; a tour without switches has them do nothing.
switch_steering() { # FILE ACTION...
  local file=$1 button=5 action
  shift
  printf '[[device]]\nproduct_name = "session-pad"\n[[device.button]]\ncontrol = "button-3"\naction = "tour"\n' >"$file"
  for action; do printf '[[device.button]]\ncontrol = "button-%s"\naction = "%s"\n' "$((button++))" "$action" >>"$file"; done
}

# light_changes FILE: how often a part of the light went on or off in a ledger.
light_changes() {
  awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) if ($i ~ /^(sunlight|shadows|lamps|fog)$/) part[i] = 1; next }
    { for (i in part) { if (NR > 2 && $i != last[i]) ++n; last[i] = $i } } END { print n + 0 }' "$1"
}

# In turns: three tours with switches, and three without. SUREFOOT_SWITCH_SECONDS shortens each, to see that it runs: no figure is kept.
switches_group() {
  local seconds=${SUREFOOT_SWITCH_SECONDS:-60} turn kind frames=0 own=0 missed=0 plain_frames=0 plain_own=0 plain_missed=0 changes=0 status
  local of=(--command "tests/bench/run switches")
  "$build/tests/bench_switch_recording" "$seconds" >"$work/switches.hid" || { failed=1; return 0; }
  switch_steering "$work/switches.toml" sunlight shadows lamps fog
  switch_steering "$work/no-switches.toml"
  load $((8 * seconds + 60)) switches || return 0
  for turn in 1 2 3; do
    for kind in switches no-switches; do
      status=0
      measure "$kind $turn" "$surefoot" walk "$work/lamps.walk" --input "$work/switches.hid" --steering "$work/$kind.toml" --hour 22 \
        --rate 30 --state "$state" --ledger "$work/$kind.csv" --json || status=1
      (( status == 0 )) || continue
      if [[ $kind == switches ]]; then
        frames=$((frames + $(value frames))) own=$((own + $(value own_misses))) missed=$((missed + $(value misses)))
        changes=$((changes + $(light_changes "$work/$kind.csv")))
      else
        plain_frames=$((plain_frames + $(value frames))) plain_own=$((plain_own + $(value own_misses))) plain_missed=$((plain_missed + $(value misses)))
      fi
    done
  done
  unload
  echo "tests/bench/run: with $changes changes of the light $missed misses in $frames frames, $own own; without $plain_missed in $plain_frames, $plain_own own" >&2
  if (( frames == 0 || changes == 0 )); then failed=1; return 0; fi
  [[ -z "${SUREFOOT_SWITCH_SECONDS:-}" ]] || return 0
  keep switch_own "$(sum "$own * 1800 / $frames")" --scene "lamps, 22 h" "${of[@]}" \
    --note "$missed misses, $own of them own, in $frames frames with $changes changes of the light; $plain_missed and $plain_own in $plain_frames without."
}
