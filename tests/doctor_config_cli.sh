#!/usr/bin/env bash
# The command line's contract for `surefoot doctor` and `surefoot config`.
# usage: doctor_config_cli.sh SUREFOOT
set -u
surefoot=$(realpath "$1")
source "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/contract.sh"

# doctor: a root where nothing can be seen is neither pass nor failure; a part that fails is exit 1.
mkdir empty bad; mkdir -p bad/proc/sys/kernel; echo 1 > bad/proc/sys/kernel/timer_migration
expect 0 '' doctor --root empty --json
valid_json out || complain "doctor --json is not one JSON object"
grep -q '"pass": 0,' out || complain "an empty root passes something"
[ "$(grep -c '"name"' out)" -ge 25 ] || complain "fewer than 25 checks"
[ "$(grep -c '"status": "unknown"' out)" -eq "$(grep -c '"name"' out)" ] || complain "not all is unknown on an empty root"
expect 1 '' doctor --root bad
grep -q 'sysctl -w kernel.timer_migration=0' out || complain "no remedy in the table"
grep -q $'\033' out && complain "colour where stdout is no terminal"
expect 2 'This is not a folder' doctor --root absent
expect 2 '--seconds.*--quick' doctor --seconds 2 --quick
expect 2 '--seconds.*--root' doctor --root empty --seconds 2
expect 2 'number from 1' doctor --seconds nan
expect 2 'frame-core 1023.*Choose' doctor --quick --frame-core 1023
"$surefoot" doctor --quick --json >out 2>err; got=$?
[ $got -le 1 ] || complain "exit $got of doctor --quick"
valid_json out || complain "doctor --quick --json is not one JSON object"
grep -q '"wake_up": null' out || complain "--quick measured"
"$surefoot" doctor --seconds 1 --json >out 2>err; got=$?
[ $got -le 1 ] || complain "exit $got of doctor --seconds 1"
grep -q '"p999_us"' out || complain "no wake-up figures"
"$surefoot" doctor --help | grep -qi 'exit status: 0 nothing fails' || complain "--help does not say the exit status"
"$surefoot" doctor --seconds 60 >out 2>err & pid=$!
eventually 30 hears_interrupt $pid || complain "the doctor does not listen to Ctrl-C"
kill -INT $pid; wait $pid; got=$?
[ $got -eq 130 ] || complain "exit $got, not 130, of a stopped doctor"
[ "$(wc -l < err)" -eq 1 ] || complain "not one line of a stopped doctor: $(cat err)"

# config: what it writes it takes; what is wrong is told, all of it.
expect 0 '' config --print --defaults; cp out defaults.toml
expect 0 '' config defaults.toml --check; grep -q 'OK' out || complain "no OK"
expect 0 '' config defaults.toml --check --json; valid_json out || complain "config --check --json is not JSON"
sed 's/^# \([a-z_]* = \)/\1/' defaults.toml > live.toml; expect 0 '' config live.toml --check
[ "$(grep -c '^[a-z_]* = ' live.toml)" -ge 20 ] || complain "the defaults lack keys"
printf 'widht = 640\nrate_hz = 0\n[profile.kiosk]\nfifo = 3\n' > wrong.toml
expect 1 "wrong.toml:1: The key 'widht' is unknown.*width" config wrong.toml --check
grep -q 'wrong.toml:2: The value rate_hz = 0 is not allowed. Use a number from 1 to 1000 (Hz).' err || complain "line 2 is not told: $(cat err)"
grep -q 'wrong.toml:4: The value fifo = 3 is not allowed. Use true or false.' err || complain "line 4 is not told: $(cat err)"
expect 1 'wrong.toml:1' config wrong.toml --check --json; valid_json out || complain "config --check --json is not JSON"
grep -q '"nearest": "width"' out || complain "the nearest key is not in the JSON"
grep -q '"allowed": "true or false"' out || complain "what is allowed is not in the JSON"
expect 1 'absent.toml' config absent.toml --check
expect 1 'wrong.toml:1' config wrong.toml --print
printf 'width = 640\n[profile.kiosk]\nrate_hz = 60\n' > good.toml
expect 0 '' config good.toml --profile kiosk --set height=480 --print
grep -qE '^rate_hz +60 +Hz +good.toml:3 \(profile kiosk\) +a number from 1 to 1000' out || complain "rate_hz: $(grep rate_hz out)"
grep -qE '^height +480 +px +command line' out || complain "height: $(grep ^height out)"
grep -qE '^late +"lock" +default' out || complain "late: $(grep ^late out)"
expect 0 '' config good.toml --profile kiosk --print --json; valid_json out || complain "config --print --json is not JSON"
grep -q '"origin": "good.toml:3 (profile kiosk)"' out || complain "no origin in the JSON"
expect 1 "no profile 'kisok'.*kiosk" config good.toml --profile kisok --print
expect 2 '--check.*file' config --check
expect 2 '--check.*no values' config good.toml --check --print
expect 2 '--profile.*file' config --profile kiosk
expect 2 '--set height' config --set height
expect 2 '--set height=1' config --set height=1
expect 2 '--defaults' config good.toml --print --defaults
for command in "doctor --quick" "doctor --root empty" "config" "config good.toml --check"; do
  "$surefoot" $command >/dev/full 2>err; [ $? -eq 1 ] || complain "no failure on a full stdout: $command"
done

verdict "doctor and config"
