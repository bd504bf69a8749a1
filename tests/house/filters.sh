#!/usr/bin/env bash
# Every filter of cases in tests/CMakeLists.txt (ALONE, NIGHTLY, WAITS, THREAD) names a case that exists: a program that is
# started with a filter of nothing passes.
# Usage: filters.sh SOURCE_FOLDER
set -euo pipefail
cd "${1:?usage: filters.sh SOURCE_FOLDER}"

# room, pattern: one line each. A call of surefoot_tests may take several lines.
patterns() {
  tr '\n' ' ' < tests/CMakeLists.txt | grep -oE 'surefoot_tests\([^)]*\)' |
    while read -r call; do
      room=$(sed -E 's/surefoot_tests\(([a-z]+).*/\1/' <<< "$call")
      { grep -oE '(ALONE|NIGHTLY|WAITS|THREAD) +"[^"]*"' <<< "$call" || true; } |
        sed -E 's/.*"(.*)"/\1/; s/-/:/' | tr ':' '\n' | sed "/^\$/d; s/^/$room /"
    done
}

checked=0
failed=0
while read -r room pattern; do
  [ "$pattern" = "*" ] && continue
  expression="^$(sed -e 's/[.]/\\./g; s/[*]/.*/g' <<< "$pattern")\$"
  cases=$(grep -ohE 'TEST(_F|_P)?\([A-Za-z0-9_]+, *[A-Za-z0-9_]+\)' "tests/$room"/*_test.cpp |
    sed -E 's/TEST(_F|_P)?\(([A-Za-z0-9_]+), *([A-Za-z0-9_]+)\)/\2.\3/')
  checked=$((checked + 1))
  if ! grep -qE "$expression" <<< "$cases"; then
    echo "tests/CMakeLists.txt: no case of tests/$room has the name $pattern. Correct the filter, or delete it"
    failed=1
  fi
done < <(patterns)
if [ "$checked" -lt 10 ]; then
  echo "only $checked filters were found in tests/CMakeLists.txt: the reading of it in $0 has to be mended"
  failed=1
fi
[ "$failed" = 0 ] && echo "$checked filters name cases that exist"
exit "$failed"
