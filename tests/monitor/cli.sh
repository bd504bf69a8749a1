#!/usr/bin/env bash
# A walk that can be looked at: `walk --monitor`, `status`, `top` and a scraper, on the tool itself.
# usage: cli.sh SUREFOOT
set -u
surefoot=$(realpath "$1")
source "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/../contract.sh"
unset RUNTIME_DIRECTORY

"$surefoot" scene forest --scale 0.3 -o f.glb >/dev/null && "$surefoot" bake f.glb -o f.walk >/dev/null || complain "no model to walk"
socket=unix:$work/s.sock

# Nobody there: the place, the remedy, and exit 1; wrong use is 2.
for command in status top "status --json"; do
  expect 1 's.sock.*No program serves this address.*surefootd' $command --socket "$socket"
  expect 2 'loopback' $command --socket 192.168.0.1:9464
  expect 2 'not an address' $command --socket nonsense
done
RUNTIME_DIRECTORY=$work/run expect 1 "$work/run/surefoot.sock" status
expect 2 'not an address' walk f.walk --clock virtual --backend null --frames 5 --monitor nonsense
expect 1 'nonexistent' walk f.walk --clock virtual --backend null --frames 5 --monitor /nonexistent/s.sock
expect 1 'incidents|proc' walk f.walk --clock virtual --backend null --frames 5 --incidents /proc/nowhere

# A walk in real time without GL, looked at while it runs.
mkfifo messages
"$surefoot" walk f.walk --backend null --no-fifo --seconds 60 --monitor "$socket" --incidents incidents --json >walk.out 2>messages &
walk=$!
exec 3<messages
# wait_for WORDS: waits until the walk prints them, for half a minute at most; its messages go on to walk.err.
wait_for() {
  local message
  while IFS= read -r -t 30 message <&3; do printf '%s\n' "$message" >>walk.err; case $message in *"$1"*) return ;; esac; done
  complain "the walk never prints '$1': $(cat walk.err)"
}
wait_for 'Watch the walk live'
"$surefoot" top --socket "$socket" --every 0.2 --seconds 30 --json </dev/null 2>/dev/null |
  grep -qm 1 '"state":"walking".*"totals":{"frames":[1-9][0-9]' || complain "no frames are seen: $(cat walk.err)"
grep -q "surefoot top --socket $socket" walk.err || complain "the walk does not say how to look at it: $(cat walk.err)"
"$surefoot" status --socket "$socket" >out 2>err || complain "status: $(cat err)"
grep -q 'f.walk' out && grep -q 'p99.9' out && grep -q 'slots:' out || complain "status says: $(cat out)"
grep -q $'\033' out && complain "colour in a pipe"
"$surefoot" status --socket "$socket" --json >out 2>err; valid_json out || complain "status --json is not JSON"
"$surefoot" top --socket "$socket" --every 0.2 --seconds 1 </dev/null >out 2>err || complain "top in a pipe: $(cat err)"
[ "$(wc -l < out)" -ge 3 ] && grep -q 'frames/s' out && ! grep -q $'\033' out || complain "top in a pipe says: $(cat out)"
"$surefoot" top --socket "$socket" --every 0.2 --seconds 1 --json </dev/null >out 2>err || complain "top --json: $(cat err)"
head -1 out > line; valid_json line || complain "a line of top --json is not JSON"
"$surefoot" status --socket "$socket" >/dev/full 2>err && complain "a full stdout is a success"
"$surefoot" top --socket "$socket" --every 0.2 2>err | head -1 >/dev/null; [ "${PIPESTATUS[0]}" -le 1 ] || complain "top where the reader left: $(cat err)"
expect 1 'in use' walk f.walk --clock virtual --backend null --frames 5 --monitor "$socket"
if command -v curl >/dev/null; then
  curl -s --unix-socket "$work/s.sock" http://localhost/metrics >out || complain "a scrape fails"
  grep -q '^surefoot_frames_total [1-9]' out || complain "no frames in the scrape: $(head -c 300 out)"
  curl -s -o /dev/null -w '%{content_type}' --unix-socket "$work/s.sock" http://localhost/metrics | grep -q 'version=0.0.4' || complain "the content type"
fi

# In a terminal: the other screen while it runs, and everything as it was after q.
if command -v script >/dev/null; then
  : >typescript
  (timeout 20 grep -qm 1 'frame time' <(tail -n +1 -f --pid=$$ typescript 2>/dev/null); printf q) | timeout 30 script -qefc "stty rows 24 cols 80; stty -a > before.tty; \"$surefoot\" top --socket $socket; stty -a > after.tty" typescript >/dev/null 2>&1
  cmp -s before.tty after.tty || complain "the terminal is not as it was"
  grep -q $'\033\\[?1049h' typescript && grep -q $'\033\\[?1049l' typescript && grep -q $'\033\\[?25h' typescript || complain "the screen is not given back"
  grep -q 'frame time' typescript || complain "top shows no frame times"
fi

# A burst of misses is written down, with a frame of it that can be replayed.
kill -STOP $walk; sleep 0.3; kill -CONT $walk
wait_for 'burst of misses'
[ -s "$(ls incidents/incident-*/ledger.csv | head -1)" ] || complain "a stop of 0.3 s left no incident"
"$surefoot" replay incidents/incident-*/frame.capture >out 2>err || complain "its frame cannot be replayed: $(cat err)"

kill -INT $walk; cat <&3 >>walk.err; wait $walk; got=$?
[ $got -eq 130 ] || complain "exit $got, not 130, of the stopped walk: $(cat walk.err)"
valid_json walk.out || complain "the walk's own figures are gone"
[ -e s.sock ] && complain "the socket is left behind"
ls -d incidents/.incident* 2>/dev/null && complain "half an incident is left"

verdict "the monitor's command line"
