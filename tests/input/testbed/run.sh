#!/usr/bin/env bash
# Runs a test program in which /dev, /sys and udev's events are umockdev's; exit 77 (skipped) with the reason where it cannot.
# usage: run.sh PROGRAM [SANITIZERS] [ARGUMENTS...]
set -u
program=${1:-} sanitizers=${2:-}
shift 2
skip() { echo "SKIPPED: $*"; exit 77; }
[[ -n "$program" ]] || skip "umockdev is not installed (Debian: umockdev, libumockdev-dev); live devices are not tested"
case ",$sanitizers," in
  *,thread,*) skip "the thread sanitizer does not work with umockdev's preloaded library" ;;
esac
preload=libumockdev-preload.so.0
# A sanitizer's library must come first of all that are preloaded.
for library in libasan libubsan; do
  path=$(ldd "$program" | awk -v l="$library" '$1 ~ "^" l {print $3}')
  [[ -n "$path" ]] && runtime=${runtime:+$runtime:}$path
done
preload=${runtime:+$runtime:}$preload
if (( $# > 0 )); then LD_PRELOAD=$preload exec "$program" "$@"; fi
# Most of it is waiting, for a hand or for a limit to pass: two at a time, each with devices of its own.
shards=2 failed=0 pids=()
log=$(mktemp -d) || exit 1
trap '(( ${#pids[@]} )) && kill "${pids[@]}" 2>/dev/null; rm -rf "$log"' EXIT
for (( shard = 0; shard < shards; ++shard )); do
  LD_PRELOAD=$preload GTEST_TOTAL_SHARDS=$shards GTEST_SHARD_INDEX=$shard "$program" >"$log/$shard" 2>&1 &
  pids+=($!)
done
for (( shard = 0; shard < shards; ++shard )); do
  wait "${pids[shard]}" || failed=1
  cat "$log/$shard"
done
exit $failed
