#!/usr/bin/env bash
# Every source is as clang-format 14 leaves it, which is Debian 12's: other versions break lines elsewhere.
# usage: format.sh SOURCE_DIR    exit status 77: not looked at, with the reason
set -u
cd "$1" || exit 1
tool=
for candidate in clang-format-14 clang-format; do
  if "$candidate" --version 2>/dev/null | grep -q 'version 14\.'; then tool=$candidate; break; fi
done
if [[ -z "$tool" ]]; then echo "SKIPPED: clang-format 14 is not installed: apt-get install clang-format-14"; exit 77; fi
mapfile -d '' -t sources < <(find rt render input config systemd tests tools \( -name '*.cpp' -o -name '*.hpp' \) -print0)
if (( ${#sources[@]} < 100 )); then echo "only ${#sources[@]} sources found below $PWD" >&2; exit 1; fi
if ! "$tool" --dry-run -Werror "${sources[@]}"; then
  echo "format with: git ls-files '*.cpp' '*.hpp' | xargs $tool -i" >&2
  exit 1
fi
echo "${#sources[@]} sources"
