# Read by the contract scripts: a folder of their own, what a command must do, and the verdict. Not run by itself.
# shellcheck shell=bash

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
failures=0
export XDG_STATE_HOME=$work/state
unset STATE_DIRECTORY

complain() { echo "FAIL: $*"; failures=$((failures + 1)); }
# expect CODE PATTERN COMMAND...: exit code, and stderr that matches PATTERN (empty: any); what it said is in out and err
expect() {
  local code=$1 pattern=$2; shift 2
  timeout 100 "$surefoot" "$@" >out 2>err; local got=$?
  [ $got -eq "$code" ] || complain "exit $got, not $code: surefoot $*: $(head -c 300 err)"
  [ -z "$pattern" ] || grep -qE -e "$pattern" err || complain "stderr says '$(head -c 300 err)', not /$pattern/: surefoot $*"
}
# eventually SECONDS COMMAND...: whether COMMAND succeeds at some moment within SECONDS: for what another process does and announces to nobody.
eventually() { local end=$((SECONDS + $1)); shift; until "$@"; do (( SECONDS < end )) || return 1; sleep 0.05; done; }
# hears_interrupt PID: Ctrl-C reaches a handler of the program, and no longer ends it at once. Until it is started, PID is this shell's fork:
# a signal would run the trap above there, which removes the folder.
hears_interrupt() { [ "$(readlink "/proc/$1/exe")" != "$(readlink "/proc/$$/exe")" ] && (( 0x$(awk '/^SigCgt/ { print $2 }' "/proc/$1/status") & 2 )); }
valid_json() { if command -v python3 >/dev/null; then python3 -c 'import json,sys; json.load(open(sys.argv[1]))' "$1"; else
  echo "python3 is absent: $1 is only looked at for its braces"; [ "$(head -c 1 "$1")" = "{" ] && [ "$(tail -c 2 "$1")" = "}" ]; fi; }
# verdict NAME: the last line of a script; its exit code.
verdict() { if [ $failures -gt 0 ]; then echo "$failures failures"; exit 1; fi; echo "$1: the contract is kept"; }
