#!/usr/bin/env bash
# A scene without effects costs the bare pipeline's instructions (callgrind): at most 1 % more; a scene with one costs more.
# Baked shadows add at most 2 % to the sun.
# usage: frame_instructions.sh PROGRAM   prints one JSON object; exit 77 (skipped) where valgrind is missing.
set -euo pipefail
program=$1
command -v valgrind >/dev/null || { echo "SKIPPED: valgrind is not installed"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export LP_NUM_THREADS=0 MESA_SHADER_CACHE_DISABLE=true

frames=8
counted() { # KIND: instructions of FRAMES frames; what it prints goes to $work/KIND
  local at_start count
  for at_start in no yes; do # a program that was built without valgrind's header does not say when to begin: from the start, then
    valgrind --tool=callgrind --callgrind-out-file=/dev/null --instr-atstart=$at_start --toggle-collect=surefoot_counted_frame \
      "$program" "$1" $frames >"$work/$1" 2>"$work/log" || { cat "$work/log" >&2; return 1; }
    count=$(sed -n 's/.*Collected : \([0-9]*\).*/\1/p' "$work/log")
    if (( count > 0 )); then break; fi
  done
  echo "$count"
}
declare -A frame
for kind in bare plain sun pixel shadow moving; do
  n=$(counted "$kind")
  frame[$kind]=$((n / frames))
done
[[ ${frame[bare]} -gt 1000000 ]] || { echo "nothing was counted: ${frame[bare]} instructions a frame" >&2; exit 1; }
picture() { cut -d' ' -f1 "$work/$1"; }
ratio() { awk "BEGIN { printf \"%.4f\", ${frame[$1]} / ${frame[bare]} }"; }
printf '{"instructions_per_frame": {"bare": %d, "plain": %d, "sun": %d, "pixel": %d, "shadow": %d, "moving": %d}, "plain_over_bare": %s, "sun_over_bare": %s, "pixel_over_sun": %s, "shadow_over_sun": %s}\n' \
  "${frame[bare]}" "${frame[plain]}" "${frame[sun]}" "${frame[pixel]}" "${frame[shadow]}" "${frame[moving]}" "$(ratio plain)" "$(ratio sun)" \
  "$(awk "BEGIN { printf \"%.4f\", ${frame[pixel]} / ${frame[sun]} }")" \
  "$(awk "BEGIN { printf \"%.4f\", ${frame[shadow]} / ${frame[sun]} }")"
[[ $(picture bare) == $(picture plain) ]] || { echo "the two programs draw different pictures" >&2; exit 1; }
[[ $(picture sun) != $(picture plain) ]] || { echo "the sun changes nothing: the scene shows nothing" >&2; exit 1; }
[[ $(picture pixel) != $(picture sun) ]] || { echo "light by the pixel changes nothing" >&2; exit 1; }
[[ $(picture shadow) != $(picture sun) ]] || { echo "the shadows change nothing" >&2; exit 1; }
[[ $(picture moving) != $(picture plain) ]] || { echo "nothing moves" >&2; exit 1; }
awk "BEGIN { exit !(${frame[shadow]} > ${frame[sun]} && ${frame[shadow]} <= 1.02 * ${frame[sun]}) }" || { echo "shadows cost nothing, or more than 2 %" >&2; exit 1; }
awk "BEGIN { exit !(${frame[plain]} <= 1.01 * ${frame[bare]}) }" || { echo "more than 1 % above the bare pipeline" >&2; exit 1; }
awk "BEGIN { exit !(${frame[sun]} > 1.01 * ${frame[bare]}) }" || { echo "an effect costs nothing: this test cannot fail" >&2; exit 1; }
