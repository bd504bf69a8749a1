#!/usr/bin/env bash
# surefoot walk --input: a recorded visitor steers; its contract on the tool itself.
# usage: input_cli.sh SUREFOOT MAKE_SESSION DEVICES_FOLDER
set -u
surefoot=$(realpath "$1") make_session=$(realpath "$2") devices=$(realpath "$3")
source "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/../contract.sh"
virtual="--clock virtual --backend null"

# refuse CODE PATTERN COMMAND...: as expect, nothing on stdout, and one line and its remedy on stderr
refuse() {
  expect "$@"
  [ -s out ] && complain "stdout is not empty: surefoot ${*:3}"
  [ "$(wc -l < err)" -le 2 ] || complain "more than a line and its remedy: $(head -c 600 err)"
}
# walk SESSION OPTIONS...: a success; its JSON is in out
walk() { local session=$1; shift
  "$surefoot" walk f.walk $virtual --input "$session" --json "$@" >out 2>err || complain "exit $? of --input $session $*: $(head -c 300 err)"; }
json_has() { tr -d ' \n' <out | grep -qE -e "$1" || complain "the JSON has no /$1/: $(tr -d ' \n' <out | grep -oE '"input":\{.*' | head -c 700)"; }
hash_of() { grep -o '"cut_hash": "[0-9a-f]*"' out; }

"$surefoot" scene forest --scale 0.3 -o f.glb >/dev/null && "$surefoot" bake f.glb -o f.walk >/dev/null 2>&1 || complain "no model"
for session in walk-and-turn buttons stopped; do "$make_session" $session $session.hid || complain "no session $session"; done

# It steers: as long as the recording and a second, the same every time, and not along the path.
walk walk-and-turn.hid --ledger steered.csv --capture c.cap --capture-frame 60 --report page
json_has '"input":\{"source":"walk-and-turn.hid","devices":1,.*"class":"navigation".*"reports":2039,"reports_shown":2039,"refused":0'
json_has '"age_ms":\{"p50":[0-9.]+,"p99":[0-9.]+,"max":[0-9.]+\},"stops":0'
json_has '"frames":275,'
first=$(hash_of)
walk walk-and-turn.hid --workers 3; [ "$(hash_of)" = "$first" ] || complain "another cut hash with three workers"
head -1 steered.csv | grep -q 'input_age_us,input_reports,stopped' || complain "the ledger does not say how old the input was"
awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) at[$i] = i; next } { n = $at["input_reports"] } END { exit n == 2039 ? 0 : 1 }' steered.csv ||
  complain "the last frame does not hold every report"
"$surefoot" replay c.cap >out 2>err || complain "the capture of a steered walk is not replayed"
grep -q 'steered by <b>walk-and-turn.hid' page/index.html || complain "the page does not say who steered"
"$surefoot" walk f.walk $virtual --json >out 2>err; json_has '"input":null'; [ "$(hash_of)" = "$first" ] && complain "the input changed nothing"
walk walk-and-turn.hid --frames 30; json_has '"frames":30,'
walk walk-and-turn.hid --path f.path.csv --seconds 2; json_has '"frames":60,'
"$surefoot" walk f.walk $virtual --input walk-and-turn.hid >out 2>err
grep -q '^input .*reports of session-pad (default: gamepad)' out || complain "the table does not say what steered: $(grep input out)"

# Buttons, and a stop that a steering file binds.
walk buttons.hid; json_has '"presses":\{"next_viewpoint":1,"reset":1,"tour":1,"pause":1\},"jumps":3'
cat > stop.toml <<'T'
[[device]]
name = "pad with a stop"
vendor = 0x1d50
[[device.axis]]
control = "y"
action = "forward"
invert = true
[[device.button]]
control = "button-5"
action = "stop"
T
walk stopped.hid --steering stop.toml; json_has '"stops":1,"stopped_frames":[1-9][0-9]*,"stop_latched":true'
"$surefoot" walk f.walk $virtual --input stopped.hid --steering stop.toml >out 2>err
tr -s ' \n' ' ' <out | grep -q '1 emergency stop; the walk stood still for' || complain "the table does not tell of the stop: $(cat out)"

# Bad input is 1: the file, the place, what and the remedy. Wrong use is 2.
refuse 1 '^surefoot: absent.hid' walk f.walk $virtual --input absent.hid
: >empty.hid; refuse 1 '^surefoot: empty.hid: .*R: line' walk f.walk $virtual --input empty.hid
grep -v '^E:' walk-and-turn.hid >none.hid; refuse 1 '^surefoot: none.hid: .*no reports' walk f.walk $virtual --input none.hid
head -c 1990 walk-and-turn.hid >cut.hid; refuse 1 '^surefoot: cut.hid: line [0-9]+: .*announces' walk f.walk $virtual --input cut.hid
refuse 1 'boot-keyboard.hid: .*does not steer: class reject' walk f.walk $virtual --input "$devices/boot-keyboard.hid"
refuse 1 '^surefoot: f.glb' walk f.walk $virtual --input f.glb
refuse 1 '^surefoot: absent.toml' walk f.walk $virtual --input buttons.hid --steering absent.toml
refuse 2 'input' walk f.walk $virtual --input ''
printf '[motion]\nwalk_speed = 9\n' >bad.toml
refuse 1 '^surefoot: bad.toml:2: .*walk_speed' walk f.walk $virtual --input buttons.hid --steering bad.toml
sed 's/button-5/button-55/' stop.toml >other.toml
refuse 1 '^surefoot: other.toml: .*button-55' walk f.walk $virtual --input stopped.hid --steering other.toml
refuse 1 '^surefoot: --ledger .*reads' walk f.walk $virtual --input buttons.hid --ledger buttons.hid
refuse 2 '^surefoot: --steering.*--input' walk f.walk $virtual --steering stop.toml
refuse 2 '^surefoot: --control.*--input' walk f.walk --input buttons.hid --control

# Live devices: the real clock only; a file of that name is ./devices.
refuse 2 '^surefoot: --input devices: .*virtual' walk f.walk $virtual --input devices
refuse 2 '^surefoot: --clear-stop.*--input devices' walk f.walk $virtual --clear-stop
refuse 1 '^surefoot: --clear-stop.*stop' walk f.walk --backend null --input devices --clear-stop
cp walk-and-turn.hid devices; walk ./devices; json_has '"source":"./devices"'
printf '[[gpio]]\nname = "ESTOP"\nrole = "stop"\nchip = "gpiochip99"\nline = "0"\n' >panel.toml
"$surefoot" walk f.walk --backend null --no-fifo --input devices --steering panel.toml --state live --seconds 1.5 --json >out 2>err ||
  complain "a missing chip is a failure: $(head -c 300 err)"
[ "$(grep -c 'gpiochip99: The chip cannot be opened' err)" -eq 1 ] || complain "a missing chip is not said once: $(head -c 600 err)"
json_has '"frames":4[0-9],'; json_has '"stop_latched":true'
grep -q latched live/emergency-stop || complain "the stop of a missing chip is not remembered"
printf x >notdir; refuse 1 'notdir.*--state' walk f.walk --backend null --input devices --steering panel.toml --state notdir/x --seconds 1
"$surefoot" walk --help >out 2>err; grep -q -- '--input pad.hid' out || complain "the help has no example with --input"

verdict "walk --input"
