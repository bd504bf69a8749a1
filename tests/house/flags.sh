#!/usr/bin/env bash
# Plain cmake compiles every file as the release preset does, but for -Werror: what is measured is what packagers ship.
# usage: flags.sh SOURCE_DIR    exit status 77: not looked at, with the reason
set -u
command -v ninja >/dev/null || { echo "SKIPPED: ninja is not installed, which the preset wants"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$1" || exit 1
cmake --preset release -B "$work/preset" >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
cmake -S . -B "$work/plain" -G Ninja >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
for way in preset plain; do
  grep '"command":' "$work/$way/compile_commands.json" | sed "s| -Werror||; s|$work/$way|BUILD|g" | sort >"$work/$way.commands"
done
if (( $(wc -l <"$work/preset.commands") < 50 )); then echo "only $(wc -l <"$work/preset.commands") compile commands found"; exit 1; fi
if grep -q -e '-Werror' "$work/plain.commands" || ! grep -q -e '-Werror' "$work/preset/compile_commands.json"; then
  echo "-Werror is for the presets, and for them alone"; exit 1
fi
if ! diff "$work/preset.commands" "$work/plain.commands" >"$work/diff"; then
  echo "the preset and plain cmake compile differently:"; head -4 "$work/diff"; exit 1
fi
grep -q -e '-DNDEBUG' "$work/plain.commands" && { echo "checks are left out: -DNDEBUG"; exit 1; }
echo "$(wc -l <"$work/plain.commands") commands"
