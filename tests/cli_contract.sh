#!/usr/bin/env bash
# The command line's contract: exit codes, one JSON object on stdout, one clear line for bad input, and nothing good lost.
# usage: cli_contract.sh SUREFOOT
set -u
surefoot=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
failures=0
export XDG_STATE_HOME=$work/state
unset STATE_DIRECTORY

complain() { echo "FAIL: $*"; failures=$((failures + 1)); }
# expect CODE PATTERN COMMAND...: exit code, and stderr (one line and its remedy at most) that matches PATTERN
expect() {
  local code=$1 pattern=$2; shift 2
  "$surefoot" "$@" >out 2>err; local got=$?
  [ $got -eq "$code" ] || complain "exit $got, not $code: surefoot $*"
  grep -qE "$pattern" err || complain "stderr says '$(head -c 300 err)', not /$pattern/: surefoot $*"
}
valid_json() { if command -v python3 >/dev/null; then python3 -c 'import json,sys; json.load(open(sys.argv[1]))' "$1"; else
  echo "python3 is absent: $1 is only looked at for its braces"; [ "$(head -c 1 "$1")" = "{" ] && [ "$(tail -c 2 "$1")" = "}" ]; fi; }
json() { "$surefoot" "$@" --json >out 2>err || complain "exit $?: surefoot $* --json"
  valid_json out || complain "stdout is not one JSON object: surefoot $* --json"; }

json scene forest --scale 0.3 -o f.glb
cp f.glb again.glb; json scene forest --scale 0.3 -o f.glb; cmp -s f.glb again.glb || complain "a scene is not the same bits twice"
json bake f.glb -o f.walk
json inspect f.walk
json effects f.walk
json walk f.walk --clock virtual --backend null --frames 30 --ledger l.csv --trace t.json --capture c.cap --capture-frame 7
json replay c.cap --selector best-first
[ "$(wc -l < l.csv)" -eq 31 ] || complain "the ledger has not one row a frame"
valid_json t.json || complain "the trace is not JSON"

# Wrong use is 2, bad input 1; what was there is still there.
expect 2 'required|subcommand' --no-such-option
expect 2 'Required|required' bake f.glb
expect 2 'one of|selector' walk f.walk --selector best
expect 2 'size' walk f.walk --size big
cp f.walk kept.walk
expect 1 'absent.glb' bake absent.glb -o f.walk
head -c 2000 f.glb > cut.glb; expect 1 'cut.glb' bake cut.glb -o f.walk
: > empty.glb; expect 1 'empty.glb' bake empty.glb -o f.walk
printf 'v 0 0 0\nv nan 1 0\nf 1 2 9\n' > bad.obj; expect 1 'bad.obj' bake bad.obj -o f.walk
expect 1 'nonexistent' bake f.glb -o /nonexistent/f.walk
cmp -s f.walk kept.walk || complain "a failed bake changed the model that was there"
for at in 5 100 3000; do
  cp f.walk flipped.walk; printf '\xa5' | dd of=flipped.walk bs=1 seek=$at conv=notrunc status=none
  cmp -s f.walk flipped.walk || expect 1 'flipped.walk' inspect flipped.walk
done
head -c 5000 f.walk > short.walk; expect 1 'short.walk' walk short.walk --clock virtual --backend null
printf '0,0,0,0,0,0,0,1,60\n1,0,zero,0,0,0,0,1,60\n' > bad.csv
expect 1 'bad.csv.*2' walk f.walk --path bad.csv --clock virtual --backend null
expect 1 'nonexistent' walk f.walk --clock virtual --backend null --frames 5 --ledger /nonexistent/l.csv
head -c 300 c.cap > short.cap; expect 1 'short.cap' replay short.cap
printf 'rate_hz = 30\nselektor = "flat"\n' > s.toml
expect 2 's.toml:2.*selek' walk f.walk --config s.toml

if [ $failures -gt 0 ]; then echo "$failures failures"; exit 1; fi
echo "the command line keeps its contract"
