#!/usr/bin/env bash
# clang-tidy on the named sources, or on all that are built; any warning fails. Prints each once.
# usage: tidy.sh BUILD_DIR JOBS [SOURCE...]    BUILD_DIR is configured with SUREFOOT_UNITY; sources are named from the root of the project
#
# Most of clang-tidy's time goes to the headers, so the sources of a unity batch are joined into one unit: the headers are then matched once
# for up to 16 sources. The sources are copied into it: clang-tidy's analyzer follows no path through an included file.
# TIDY_ANALYZER=off leaves the analyzer out. It never runs on tests: there it takes ten times the compiler's time, for the branches of
# GoogleTest's macros. Elsewhere it looks at 75,000 states of a function, a third of its default, in less than half of the time.
set -euo pipefail
build=$1 jobs=$2
shift 2
root=$PWD units=$PWD/$build/units
rm -rf "$units"
mkdir -p "$units"
declare -A wanted=() taken=()
for source in "$@"; do wanted[$source]=1; done

# Each entry of the compile commands: the compiler's arguments, then the file.
entries() {
  sed -nE 's/^ *"command": "[^ ]+ (.*) -o [^ ]+ -c .*",$/\1/p; s/^ *"file": "(.*)".*$/\1/p' "$build/compile_commands.json" | sed 's/\\\(["\\]\)/\1/g'
}

count=0
while IFS= read -r arguments && IFS= read -r file; do
  sources=("$file") kept=()
  if [[ $file == */Unity/* ]]; then mapfile -t sources < <(sed -n 's/^#include "\(.*\)"$/\1/p' "$file"); fi
  for source in "${sources[@]}"; do
    source=${source#"$root/"}
    if [[ -n "${taken[$source]:-}" || ($# -gt 0 && -z "${wanted[$source]:-}") ]]; then continue; fi
    taken[$source]=1
    kept+=("$source")
  done
  if (( ${#kept[@]} == 0 )); then continue; fi
  count=$((count + 1)) unit=$units/$count checks=()
  for source in "${kept[@]}"; do printf '// source: %s\n' "$source" | cat - "$source"; done >"$unit.cpp"
  if [[ "${TIDY_ANALYZER:-on}" == off || ${kept[0]} == tests/* ]]; then checks=("--checks='-clang-analyzer-*'"); fi
  echo "clang-tidy --quiet --warnings-as-errors='*' ${checks[*]} $unit.cpp -- $arguments -Xclang -analyzer-config -Xclang max-nodes=75000 >$unit.out 2>$unit.err || { cat $unit.err >>$unit.out; exit 1; }" >"$unit.sh"
done < <(entries)
if (( count == 0 )); then echo "0 warnings: none of the sources is built"; exit 0; fi

status=0
# The largest first, so that no core waits at the end for one.
find "$units" -name '*.cpp' -printf '%s %p\n' | sort -rn | sed 's/.* //; s/cpp$/sh/' | xargs -P "$jobs" -n 1 bash || status=1

# Places in a unit become places in its sources.
for out in "$units"/*.out; do
  unit=${out%.out}.cpp
  awk -v "unit=$unit:" '
    FNR == NR { if (/^\/\/ source: /) { start[++n] = FNR; name[n] = $3 } next }
    index($0, unit) == 1 {
      place = substr($0, length(unit) + 1); line = place + 0; sub(/^[0-9]+/, "", place)
      for (i = n; start[i] > line; --i) {}
      $0 = name[i] ":" (line - start[i]) place
    }
    { print }' "$unit" "$out"
done >"$units/all.log"
warnings=$(grep -E '(warning|error): ' "$units/all.log" | sort -u || true)
if (( status )) && [[ -z "$warnings" ]]; then tail -20 "$units/all.log"; fi
if [[ -n "$warnings" ]]; then printf '%s\n' "$warnings"; fi
echo "$(grep -c . <<<"$warnings" || true) warnings in ${#taken[@]} sources, $count units"
exit "$status"
