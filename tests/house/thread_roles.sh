#!/usr/bin/env bash
# A device and a steering belong to one thread: code that has not said that it is that thread's gets a warning from clang.
# usage: thread_roles.sh SOURCES
set -u
cd "$1" || exit 1
compiler=$(command -v clang++) || { echo "SKIPPED: there is no clang++ here"; exit 77; }
code=$'#include "input/report_source.hpp"\n#include "render/gl/device.hpp"\nusing namespace surefoot;'
line=3 wanted=() failures=0
complain() { echo "FAIL: $1"; failures=$((failures + 1)); }

# takes BODY, warns BODY: a function of its own, on a line of its own, without a warning and with one.
takes() { line=$((line + 1)); code+=$'\n'"void f$line(gl::Device& device, const Pose& pose, input::Steering& steering, input::ReportSource& source) { (void)device, (void)pose, (void)steering, (void)source; $1; }"; }
warns() { takes "$1"; wanted+=("$line"); }

takes 'device.draws.plays(); device.begin_frame(pose); device.finish_frame()'
takes 'device.bind(); device.begin_frame(pose); device.finish_frame(); device.release()'
warns 'device.bind(); device.release(); device.begin_frame(pose)'
for call in 'begin_frame(pose)' 'draw({})' 'end_slice()' 'wait_slices(1)' 'end_items()' 'finish_frame()' 'present()' 'stats()' 'lost()' 'read_pixels()' \
    'begin_timer()' 'end_timer_ms()' 'charged_us()' 'release()' 'load({}, {})'; do
  warns "(void)device.$call"
done
takes 'steering.steers.plays(); (void)steering.tick(source.drain(steering, 1), 1)'
for call in 'steering.tick({}, 1)' 'source.drain(steering, 1)' 'source.begin(steering, 1)' 'steering.report(0, {}, 1)' 'steering.drained(0, 1)' \
    'steering.detach(0)' 'steering.ended(0)' 'steering.place({})' 'steering.safety()' 'steering.motion()' 'steering.mapper(0)'; do
  warns "(void)$call"
done

diagnostics=$(printf '%s\n' "$code" | "$compiler" -std=c++20 -I. -fsyntax-only -Wthread-safety -x c++ - 2>&1)
if grep -q 'error:' <<<"$diagnostics"; then complain "it does not compile: $diagnostics"; fi
warned=$(grep -oP '^<stdin>:\K[0-9]+(?=:.*thread role .*-Wthread-safety)' <<<"$diagnostics" | sort -nu)
for at in $(comm -23 <(printf '%s\n' "${wanted[@]}" | sort) <(sort <<<"$warned")); do complain "no warning: $(sed -n "${at}p" <<<"$code")"; done
for at in $(comm -13 <(printf '%s\n' "${wanted[@]}" | sort) <(sort <<<"$warned")); do complain "a warning: $(sed -n "${at}p" <<<"$code")"; done
if [ $failures -gt 0 ]; then echo "$failures failures"; exit 1; fi
echo "thread roles: the compiler holds them"
