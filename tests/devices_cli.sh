#!/usr/bin/env bash
# surefoot devices: the contract of its commands, on the devices beside the tests of input/.
# usage: devices_cli.sh SUREFOOT DEVICES_FOLDER
set -u
surefoot=$(realpath "$1") devices=$(realpath "$2")
source "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/contract.sh"
# prints PATTERN COMMAND...: success, and stdout that matches
prints() {
  local pattern=$1; shift
  "$surefoot" "$@" >out 2>err || complain "exit $?: surefoot $*: $(head -c 300 err)"
  tr -d '\n' <out | grep -qE "$pattern" || complain "stdout has no /$pattern/: surefoot $*"
}

for file in "$devices"/*.hid; do
  "$surefoot" devices describe "$file" --json >out 2>err || complain "exit $?: $file"
  [ -s err ] && complain "stderr of $file: $(head -c 200 err)"
  "$surefoot" devices describe "$file" >out 2>err || complain "exit $? without --json: $file"
done

nav=$devices/spacenavigator-like.hid
prints '"class": "navigation"' devices describe "$nav" --json
prints '"counts": \{ *"accepted": 8, *"short": 0, *"long": 0, *"unknown": 1' devices describe "$nav" --json
prints '"relative": false' devices describe "$nav" --json
printf '\x05\x01\x09\x04\xa1\x01\x15\x81\x25\x7f\x75\x08\x95\x01\x09\x30\x81\x02\xc0' >stick.bin
printf 'E: 0.0 1 81\nE: 0.1 2 00 00\nE: 0.2 1 7f\n' >stick.hid
prints '"status": "accepted", *"values": \{ *"x": -127 *\}.*"long": 1' devices describe stick.bin --reports stick.hid --json
prints 'x=127.*2 accepted, 0 short, 1 long, 0 unknown' devices describe stick.bin --reports stick.hid
prints 'quirk|deflect' devices describe "$nav" --vid-pid 256f:c635
prints 'Example:' devices describe --help
expect 2 'Use ids such as' devices describe stick.bin --vid-pid rubbish
expect 2 '.' devices describe
prints . devices
expect 1 'nothing.bin' devices describe nothing.bin
expect 1 'nothing.hid' devices describe stick.bin --reports nothing.hid
head -c 9 stick.bin >cut.bin
expect 1 'cut.bin: byte 8: .*cut off' devices describe cut.bin
expect 1 'cut.bin: byte 8: ' devices describe cut.bin --json
grep -q '"offset": 8' out || complain "the refusal's byte is not in the object"
printf 'E: 0.0 1 81\nE: 0.1 2 00\n' >cut.hid
expect 1 'cut.hid: line 2: ' devices describe stick.bin --reports cut.hid
: >empty.bin
expect 1 'empty.bin: byte 0: ' devices describe empty.bin
printf '# no descriptor\nE: 0.0 1 00\n' >none.hid
expect 1 'none.hid: The recording has no R: line' devices describe none.hid
head -c 5000 /dev/zero >long.bin
expect 1 'long.bin: byte 4096: ' devices describe long.bin
printf '# nothing moved\n' >still.hid
expect 1 'still.hid: The recording holds no reports' devices describe stick.bin --reports still.hid
printf '\xef\xbb\xbfE: 0.5 1 81\nE: 0.1 1 7f\n' >marked.hid
prints '2 accepted.*1 of them have a time before' devices describe stick.bin --reports marked.hid
prints '"before_the_last": 1' devices describe stick.bin --reports marked.hid --json
seq -f 'E: %.0f.0 1 11' 400000 >long.hid
# The sanitizers' own memory is larger than any such limit: there only the answer is checked.
limit=500000
(ulimit -v $limit; "$surefoot" --version >/dev/null 2>&1) || limit=unlimited
(ulimit -v $limit; "$surefoot" devices describe stick.bin --reports long.hid --json >out 2>err) ||
  complain "400 000 reports within $limit KiB: exit $?: $(head -c 200 err)"
tail -9 out | grep -q '"accepted": 400000' || complain "the object of 400 000 reports does not end with their counts"
expect 0 'another descriptor' devices describe stick.bin --reports "$nav"

# Live devices: what holds whatever is plugged in. With devices: tests/input/testbed.
for command in list watch record map; do prints 'Example:.*surefoot devices' devices $command --help; done
prints '"devices": \[' devices --json
prints '"devices": \[' devices list --json
prints '.' devices list
expect 0 'waits for one' devices watch no-such-device --seconds 0.2 --json
expect 0 'waits for one' devices watch no-such-device --seconds 0.2
expect 2 'seconds' devices watch --seconds -1
expect 2 'seconds' devices record no-such-device -o x.hid --seconds 0
expect 2 'output|required' devices record no-such-device
expect 2 'timeout' devices map --timeout never
expect 1 'no-such-device: No such device' devices record no-such-device -o x.hid
expect 1 'no-such-device: No such device' devices map no-such-device -o x.toml
[ -e x.hid ] || [ -e x.toml ] && complain "a file is left behind"
printf '[motion]\nwalk = 1\n' >bad.toml
expect 1 'bad.toml:2' devices map -o bad.toml
expect 1 'no-folder' devices map -o no-folder/x.toml

verdict "the devices command"
