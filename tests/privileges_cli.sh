#!/usr/bin/env bash
# Privileges taken away one by one: `surefoot walk` says once what it lacks and marks its figures; with --strict it does not start.
# usage: privileges_cli.sh SUREFOOT      exit 77: this machine grants too little to take something away
set -u
surefoot=$(realpath "$1")
source "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/contract.sh"
[ "$(id -u)" = 0 ] || { echo "SKIPPED: needs root: privileges are taken away from it"; exit 77; }
for tool in setpriv prlimit taskset; do command -v $tool >/dev/null || { echo "SKIPPED: $tool is absent (util-linux)"; exit 77; }; done

"$surefoot" scene forest --scale 0.3 -o f.glb >/dev/null && "$surefoot" bake f.glb -o f.walk >/dev/null 2>&1 || complain "no model"
chmod -R a+rX "$work"
walk="$surefoot walk f.walk --backend null --frames 20"
grep -q '"fifo": true' <($walk --json 2>full) || { echo "SKIPPED: SCHED_FIFO is refused even to root here"; exit 77; }
grep -q 'Memory cannot be locked' full && { echo "SKIPPED: memory cannot be locked even by root here"; exit 77; }
$walk --strict >out 2>full-strict && grep -q 'isolated' full && complain "--strict starts without an isolated core"

# lacks MARK WHAT COMMAND...: run by COMMAND, the walk lacks WHAT (a pattern) and says so once, its JSON has MARK, and --strict refuses it
lacks() {
  local mark=$1 what=$2; shift 2
  grep -qE "$what" full full-strict && complain "the full set of privileges already lacks /$what/"
  "$@" $walk --json >out 2>err || complain "exit $? instead of a degraded walk: $*: $(head -c 300 err)"
  [ "$(grep -cE "not fully real-time: .*$what" err)" -eq 1 ] || complain "not said once, /$what/: $*: $(cat err)"
  grep -qE "not fully real-time: .*$what.*\. .+\.\$" err || complain "no remedy for /$what/: $(cat err)"
  grep -q -- "$mark" out || complain "the figures are not marked with $mark: $*"
  "$@" $walk >out 2>err || complain "exit $? of the table: $*"
  [ "$(tr -s ' \n' ' ' <out | grep -oE "degraded $what" | wc -l)" -eq 1 ] || complain "the table does not say /$what/ once: $(grep -A1 degraded out)"
  "$@" $walk --strict >out 2>err; local got=$?
  [ $got -eq 1 ] || complain "exit $got, not 1, with --strict: $*"
  [ -s out ] && complain "--strict printed figures: $*"
  grep -qE "^surefoot: --strict.*does not start.*$what" err || complain "--strict does not name /$what/: $(cat err)"
}

# Where one way is closed and another open, nothing is lacking: the limit is raised with CAP_SYS_RESOURCE (bit 24), where there is one.
capabilities=$(awk '/^CapEff/ { print $2 }' /proc/self/status)
if (( 0x$capabilities >> 24 & 1 )); then
  setpriv --bounding-set=-sys_nice $walk --json >out 2>err; grep -q '"fifo": true' out || complain "RLIMIT_RTPRIO was not raised where it may be"
fi
lacks '"fifo": false' 'SCHED_FIFO is refused' prlimit --rtprio=0:0 setpriv --bounding-set=-sys_nice,-sys_resource
if prlimit --rtprio=50:50 true 2>/dev/null; then
  lacks '"fifo": false' 'SCHED_FIFO is granted only up to priority 50' prlimit --rtprio=50:50 setpriv --bounding-set=-sys_nice,-sys_resource
else
  echo "RLIMIT_RTPRIO cannot be set to 50 here: that case is left out"
fi
lacks '"locked": false' 'Memory cannot be locked beyond 2 MiB' prlimit --memlock=2097152:2097152 setpriv --bounding-set=-ipc_lock,-sys_resource
walk="$walk --frame-core 1000"
lacks '"isolated": false' 'Frame core 1000 does not exist' env
walk="$surefoot walk f.walk --backend null --frames 20 --frame-core 1"
[ "$(nproc)" -ge 2 ] && lacks '"isolated": false' 'Frame core 1 does not exist, or this process may not use it: core 0 is used' taskset -c 0

# An ordinary user lacks all of them at once, each said once, and the page is marked too.
walk="$surefoot walk f.walk --backend null --frames 20"
mkdir -m 777 page
prlimit --rtprio=0:0 --memlock=65536:65536 setpriv --reuid=65534 --regid=65534 --clear-groups \
  env XDG_STATE_HOME="$work/state" $walk --report page --json >out 2>err || complain "an ordinary user cannot walk: $(cat err)"
for what in 'SCHED_FIFO is refused' 'Memory cannot be locked'; do
  [ "$(grep -c "not fully real-time: $what" err)" -eq 1 ] || complain "an ordinary user is not told once: $what: $(cat err)"
  [ "$(grep -o "Not fully real-time: $what" page/index.html | wc -l)" -eq 1 ] || complain "the page is not marked: $what"
done
grep -q '"fifo": false' out && grep -q '"locked": false' out || complain "an ordinary user's figures are not marked"
verdict "privileges"
