#!/usr/bin/env bash
# Do compilers, levels and contraction agree? Builds the rows that draw nothing with each, and compares their digests (verdicts,
# triangle counts, cut hashes). Minutes a build; not part of tools/test.
# usage: tests/hard_matrix.sh [--scale S] [--work DIR] [NAME...]   NAME: gcc-O2 gcc-O0 gcc-O3 gcc-fma clang-O2 clang-fma; all, if none
set -uo pipefail
top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
scale=0.04
work=${TMPDIR:-/tmp}/surefoot-hard-matrix
names=()
while (( $# > 0 )); do
  case $1 in
    --scale) scale=$2; shift 2 ;;
    --work) work=$2; shift 2 ;;
    -*) sed -n '2,4p' "$0" >&2; exit 2 ;;
    *) names+=("$1"); shift ;;
  esac
done
(( ${#names[@]} > 0 )) || names=(gcc-O2 gcc-O0 gcc-O3 gcc-fma clang-O2 clang-fma)
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

first='' failed=0
for name in "${names[@]}"; do
  flags=$(flags_of "$name") || { echo "$name: no such build" >&2; exit 2; }
  compiler=g++; [[ $name == clang-* ]] && compiler=clang++
  if ! command -v $compiler >/dev/null; then echo "$name: skipped, $compiler is not installed"; continue; fi
  if [[ $name == *-fma ]] && ! grep -qw fma /proc/cpuinfo; then echo "$name: skipped, this CPU has no FMA"; continue; fi
  build=$work/$name
  # The project's own -ffp-contract=off comes later on the command line; a wrapper puts ours last.
  mkdir -p "$build"
  printf '#!/bin/sh\nexec %s "$@" %s\n' "$compiler" "$flags -Wno-error -w" >"$build/compiler"
  chmod +x "$build/compiler"
  if ! { cmake -S "$top" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER="$build/compiler" -DCMAKE_CXX_FLAGS_RELEASE="-g0" &&
         cmake --build "$build" --target hard_rows -j "${SUREFOOT_JOBS:-2}"; } >"$build/log" 2>&1; then
    echo "$name: does not build, see $build/log"; failed=1; continue
  fi
  "$build/tests/hard_rows" "$scale" "${rows[@]}" >"$build/rows" 2>&1 </dev/null
  code=$?
  # What each row was, and its digest: timings and pictures are left out.
  awk '/^[A-Z][0-9]+[a-z]? /{row=$1; verdict=$2} /digest/ && !/hard cases/{print row, verdict, $2}' "$build/rows" >"$build/digests"
  echo "$name ($flags): exit $code, $(tail -1 "$build/rows")"
  if [[ -z "$first" ]]; then first=$build; continue; fi
  if ! diff "$first/digests" "$build/digests"; then failed=1; fi
  (( code == 0 )) || failed=1
done
exit $failed
