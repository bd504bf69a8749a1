#!/usr/bin/env bash
# Each file compiles alone, without a warning: no file leans on the includes of another. The compiler stops before it makes code.
# usage: alone.sh BUILD_DIR JOBS    BUILD_DIR is configured with its warnings as errors, and without SUREFOOT_UNITY
set -euo pipefail
build=$1 jobs=$2
# A file of several targets is compiled once.
sed -nE 's/^ *"command": "(.*)",$/\1/p' "$build/compile_commands.json" | sed 's/\\\(["\\]\)/\1/g; s/ -o [^ ]* -c / -fsyntax-only /' |
  awk '!seen[$NF]++' >"$build/alone.commands"
if (( $(wc -l <"$build/alone.commands") < 100 )); then echo "only $(wc -l <"$build/alone.commands") files found in $build" >&2; exit 1; fi
status=0
tr '\n' '\0' <"$build/alone.commands" | xargs -0 -P "$jobs" -n 1 bash -c >"$build/alone.log" 2>&1 || status=1
cat "$build/alone.log"
echo "$(grep -cE '(warning|error): ' "$build/alone.log" || true) warnings in $(wc -l <"$build/alone.commands") files"
exit "$status"
