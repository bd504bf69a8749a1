#!/usr/bin/env bash
# Do compilers, levels and contraction agree? Builds the rows that draw nothing with each, and compares their digests (verdicts,
# triangle counts, cut hashes). Minutes a build, SUREFOOT_JOBS at once (2). Part of: tools/test --nightly matrix
# usage: tests/hard_matrix.sh [--scale S] [--work DIR] [--build DIR] [NAME...]
#   --build DIR  a finished release build with the target hard_rows: it takes the place of gcc-O2, which has the same options
#   NAME         gcc-O2 gcc-O0 gcc-O3 gcc-fma clang-O2 clang-fma; all, if none
set -uo pipefail
top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
scale=0.04
work=$top/build/hard-matrix
source "$top/tools/prepare.sh"  # at_once, end_children
release='' linker=()
if command -v mold >/dev/null; then linker=(-DCMAKE_EXE_LINKER_FLAGS=-fuse-ld=mold); fi
names=()
while (( $# > 0 )); do
  case $1 in
    --scale) scale=$2; shift 2 ;;
    --work) work=$2; shift 2 ;;
    --build) release=$(realpath -m "$2"); shift 2 ;;
    -*) sed -n '2,6p' "$0" >&2; exit 2 ;;
    *) names+=("$1"); shift ;;
  esac
done
(( ${#names[@]} > 0 )) || names=(gcc-O2 gcc-O0 clang-fma gcc-fma gcc-O3 clang-O2)  # the longest first; what is compared with comes before all
rows=(O1 A1 A2 A3 A4 N9 N10 N11 N13 N1 N2 N3 N4 N5 N15 N22 N7 N20 L1 L6 F1 F2 F3 F4 F5 F6 F7 N21)

flags_of() {
  case $1 in
    *-O0) echo "-O0" ;;
    *-O2) echo "-O2" ;;
    *-O3) echo "-O3" ;;
    *-fma) echo "-O3 -march=haswell -ffp-contract=fast" ;;
    *) return 1 ;;
  esac
}

for name in "${names[@]}"; do
  flags_of "$name" >/dev/null || { echo "$name: no such build" >&2; exit 2; }
done

# try NAME: one build and its rows, on one core; $work/NAME/outcome says in one line what became of it, and fails if it is bad.
try() {
  local name=$1 build=$work/$1 compiler=g++ program=$work/$1/tests/hard_rows flags code=0 began=$SECONDS built
  flags=$(flags_of "$name")
  if [[ $name == clang-* ]]; then compiler=clang++; fi
  mkdir -p "$build"
  rm -f "$build/digests" "$build/outcome"
  if ! command -v $compiler >/dev/null; then echo "$name: skipped, $compiler is not installed" | tee "$build/outcome"; return; fi
  if [[ $name == *-fma ]] && ! grep -qw fma /proc/cpuinfo; then echo "$name: skipped, this CPU has no FMA" | tee "$build/outcome"; return; fi
  # The project's own options come later on a command line than a user's; the rule puts ours last.
  if [[ $name == gcc-O2 && -n "$release" ]]; then
    program=$release/tests/hard_rows
    if [[ ! -x "$program" ]]; then echo "$name: $program is not there" | tee "$build/outcome"; return 1; fi
  elif ! { cmake -S "$top" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER=$compiler -DCMAKE_CXX_FLAGS_RELEASE=-g0 \
             "${linker[@]}" "-DCMAKE_CXX_COMPILE_OBJECT=<CMAKE_CXX_COMPILER> <DEFINES> <INCLUDES> <FLAGS> $flags -w -o <OBJECT> -c <SOURCE>" &&
           cmake --build "$build" --target hard_rows -j 1; } >"$build/log" 2>&1; then
    echo "$name: does not build, see $build/log" | tee "$build/outcome"
    return 1
  fi
  built=$SECONDS
  "$program" "$scale" "${rows[@]}" >"$build/rows" 2>&1 </dev/null || code=$?
  # What each row was, and its digest: timings and pictures are left out.
  awk '/^[A-Z][0-9]+[a-z]? /{row=$1; verdict=$2} /digest/ && !/hard cases/{print row, verdict, $2}' "$build/rows" >"$build/digests"
  times >"$build/times"  # not through a pipe: a subshell has times of its own
  echo "$name ($flags): exit $code, $(tail -1 "$build/rows"); built in $((built - began)) s, run in $((SECONDS - built)) s;" \
    "$(awk -F '[ms ]+' 'END { printf "%d", 60 * ($1 + $3) + $2 + $4 }' "$build/times") CPU s" | tee "$build/outcome"
  return $code
}

trap end_children EXIT
trap 'exit 130' INT TERM
failed=0
at_once try "${names[@]}" || failed=1
first=''
for name in "${names[@]}"; do
  digests=$work/$name/digests
  [[ -s "$digests" ]] || continue
  if [[ -z "$first" ]]; then first=$name; continue; fi
  if ! different=$(diff "$work/$first/digests" "$digests"); then
    failed=1
    printf '%s and %s do not agree:\n%s\n' "$first" "$name" "$different"
  fi
done
exit $failed
