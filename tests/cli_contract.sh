#!/usr/bin/env bash
# The command line's contract: exit codes, one JSON object on stdout, one clear line for bad input, and nothing good lost.
# usage: cli_contract.sh SUREFOOT
set -u
surefoot=$(realpath "$1")
source "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/contract.sh"
json() { "$surefoot" "$@" --json >out 2>err || complain "exit $?: surefoot $* --json"
  valid_json out || complain "stdout is not one JSON object: surefoot $* --json"; }

json scene forest --scale 0.3 -o f.glb
cp f.glb again.glb; json scene forest --scale 0.3 -o f.glb; cmp -s f.glb again.glb || complain "a scene is not the same bits twice"
json bake f.glb -o f.walk
json inspect f.walk
grep -q '"median_loss": {' out || complain "inspect has no loss of a fresh bake"
json effects f.walk
json walk f.walk --clock virtual --backend null --frames 30 --ledger l.csv --trace t.json --capture c.cap --capture-frame 7
json replay c.cap --selector best-first
[ "$(wc -l < l.csv)" -eq 31 ] || complain "the ledger has not one row a frame"
valid_json t.json || complain "the trace is not JSON"

# Levels closer to each other, and objects in one piece.
json bake f.glb -o dense.walk --level-ratio 90 --whole-objects
json inspect dense.walk
grep -q '"pieces": 0' out || complain "a model of whole objects has pieces"
forms() { grep -o '"mesh": [0-9]*' out | head -1 | tr -dc 0-9; }
dense=$(forms); json inspect f.walk; usual=$(forms)
(( dense > usual )) || complain "a level ratio of 90 % gives $dense meshes, the usual one $usual"
expect 2 'level-ratio' bake f.glb -o x.walk --level-ratio 100

# Hard cases: named rows, one line at the end, wrong names are wrong use, Ctrl-C ends it.
json selftest --hard N10 L4
grep -q '"digest"' out || complain "selftest --json has no digest"
"$surefoot" selftest --hard N7 >out 2>err || complain "exit $? of selftest --hard N7"
tail -1 out | grep -q '^hard cases: 3 of 3 rows hold; broken: none' || complain "selftest ends with '$(tail -1 out)'"
"$surefoot" selftest --hard --list >out 2>err || complain "exit $? of selftest --list"
expect 2 "row 'N99'.*--list" selftest --hard N99
expect 2 '--backend.*null.*osmesa' selftest --hard N17d --backend null
expect 2 'selftest --hard' selftest
expect 2 '--scale.*0.* 0.001 to' selftest --hard --scale 0

# Wrong use is 2, bad input 1; what was there is still there.
expect 2 "The option '--no-such-option' is unknown" --no-such-option
expect 2 "no command 'wlak'. Did you mean 'walk'" wlak f.walk
expect 2 "There is no command 'xyzzy'" xyzzy
expect 2 "^surefoot: walk: The argument 'g.walk' is superfluous" walk f.walk -- g.walk
expect 2 "^surefoot: devices: There is no command 'lst'. Did you mean 'list'" devices lst
expect 2 '^surefoot: --rate: .*value is missing' walk f.walk --rate
expect 2 '^surefoot: --json: .*takes no value' walk f.walk --json=maybe
expect 2 '^surefoot: --rate: .*given 2 times' walk f.walk --rate 30 --rate 60
expect 2 'Required|required' bake f.glb
expect 2 'one of|selector' walk f.walk --selector best
expect 2 'size' walk f.walk --size big
cp f.walk kept.walk
expect 1 'absent.glb' bake absent.glb -o f.walk
head -c 2000 f.glb > cut.glb; expect 1 'cut.glb' bake cut.glb -o f.walk
: > empty.glb; expect 1 'empty.glb' bake empty.glb -o f.walk
printf 'v 0 0 0\nv nan 1 0\nf 1 2 9\n' > bad.obj; expect 1 'bad.obj' bake bad.obj -o f.walk
expect 1 'nonexistent' bake f.glb -o /nonexistent/f.walk
triangle='v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n'
printf 'newmtl a\nmap_Kd gone.png\n' > a.mtl; printf "mtllib a.mtl\nusemtl a\n$triangle" > picture.obj
printf "mtllib gone.mtl\nusemtl a\n$triangle" > material.obj; printf "${triangle}v inf 0 0\nf 1 2 4\n" > infinite.obj
printf "${triangle}f 1 2 9\n" > index.obj
# What nobody draws may be missing: a library's other materials, loose edges, a library without a use.
printf 'newmtl a\nKd 1 0 0\nnewmtl b\nmap_Kd gone.png\n' > b.mtl
printf "mtllib b.mtl gone.mtl\nusemtl a\n${triangle}f 1 2\n" > sound.obj
"$surefoot" bake sound.obj -o sound.walk >out 2>err || complain "a model that lacks nothing it draws is refused: $(cat err)"
for lack in picture:gone.png material:gone.mtl 'infinite:position not finite' 'index:index out of range'; do
  expect 1 "${lack%%:*}.obj.*${lack#*:}.*--allow-incomplete" bake "${lack%%:*}.obj" -o f.walk
  "$surefoot" bake "${lack%%:*}.obj" -o incomplete.walk --allow-incomplete >out 2>err || complain "${lack%%:*}.obj: not baked with --allow-incomplete: $(cat err)"
  grep -q "${lack#*:}" err || complain "${lack%%:*}.obj: baked without a word of what it lacks"
done
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
mkdir -p below; printf 'model = "../f.walk"\nclock = "virtual"\nbackend = "null"\nrate_hz = 50\n' > below/m.toml
json walk --config below/m.toml --frames 5  # the model is relative to the settings' file
expect 2 'MODEL.walk: The model is not named' walk --frames 5

# Values that are not allowed: the option, what was found and what is allowed, before anything is opened.
virtual="--clock virtual --backend null"
refuse() { local pattern=$1; shift; expect 2 "^surefoot: .*$pattern" "$@"; [ -s out ] && complain "stdout is not empty: surefoot $*"
  [ "$(wc -l < err)" -eq 1 ] || complain "not one line: surefoot $*"; }
for value in -1 0 1e300 nan; do refuse "--seconds.*$value.* 0.001 to" walk f.walk $virtual --seconds $value; done
for value in -1 0 many; do refuse "--frames.*$value.* 1 to" walk f.walk $virtual --frames $value; done
for value in -1 nan inf; do refuse "--budget $value.* 0 to 1000" walk f.walk $virtual --budget $value; done
for value in 0x0 1000000x1 abc 5x 9x9x9; do
  refuse "--size $value.* 16 to 16384" walk f.walk $virtual --size $value
  refuse "--size $value.* 16 to 16384" accuracy f.walk --size $value
done
for value in 0 nan -5; do refuse "--rate $value.* 1 to 1000" walk f.walk $virtual --rate $value; done
for value in nan -1; do refuse "--cost-scale $value.* 0.01 to 100" walk f.walk $virtual --cost-scale $value; done
refuse '--accuracy nan.* 0 to' walk f.walk $virtual --accuracy nan
refuse '--lift.*nan' walk f.walk $virtual --lift nan
refuse '--cost-noise.*nan' walk f.walk $virtual --cost-noise nan
refuse '--budget.*-1.* 0.001 to' accuracy f.walk --budget -1
refuse '--shift-x.*9.* -8 to 8' accuracy f.walk --shift-x 9
refuse '--selector.*best.*two-stage' accuracy f.walk --selector best
refuse "nosuch.*forest, room, town" scene nosuch -o x.glb
for value in 0 -1 1e9 nan; do refuse "--scale.*$value.* 0.01 to 200" scene forest --scale $value -o x.glb; done
refuse '--rate.*nan' bake f.glb --rate nan -o x.walk
refuse '--backend foo.*egl' walk f.walk --clock virtual --backend foo
refuse '--cache nowhere.*off, view, surround' walk --cache=nowhere f.walk
for kept in --cache --cache=true --cache=surround --cache=off; do json walk $kept f.walk $virtual --frames 3; done
for command in "walk f.walk" "accuracy f.walk" calibrate; do refuse "--backend vulkan.*kms" $command --backend vulkan; done
refuse "mode '1920'.*WIDTHxHEIGHT@HZ" walk f.walk --backend kms --mode 1920
refuse '--rotation 45.*0, 90, 180, 270' walk f.walk --backend kms --rotation 45
# A machine without a card, or without this connector. The kernel is asked, and its answer is a sentence.
expect 1 '(/dev/dri|NOSUCH-9).*(egl|Choose|group)' walk f.walk --backend kms --screen NOSUCH-9
refuse '--profile fast.*--config' walk f.walk $virtual --profile fast
refuse '--every.*--snap' walk f.walk $virtual --every 5
refuse '--control-pairs.*--control' walk f.walk --control-pairs 3
refuse '--frames.*--control-pairs' walk f.walk --control --frames 5
refuse '--seconds.*--frames' walk f.walk $virtual --frames 5 --seconds 5
refuse '--cost-noise.*--clock virtual' walk f.walk --backend null --cost-noise 0.1
refuse '--strict' walk f.walk $virtual --strict

# Options for experiments are taken, and not shown; those that later work needs are. Names come with a line of help each.
"$surefoot" walk --help > help
for option in --slice --hysteresis --cost-noise; do grep -qe "$option" help && complain "walk --help shows $option"; done
for option in --no-check --no-occlusion --no-correction --cost-scale; do grep -qe "$option" help || complain "walk --help lacks $option"; done
expect 0 '' walk f.walk $virtual --frames 5 --slice 500 --hysteresis 1 --cost-noise 0.1
grep -qE '^ +two-stage +[a-z].{10}' help || complain "walk --help does not say what two-stage is"
"$surefoot" config --print --defaults > page; grep -qE '^#   two-stage +[a-z].{10}' page || complain "the settings page does not say what two-stage is"
printf 'backend = "vulkan"\n' > kms.toml; refuse 'kms.toml:1.*vulkan.*kms' walk f.walk --config kms.toml

# Outputs: asked for beforehand, never over an input; one that fails spoils no other.
expect 1 'over.obj: .*\.obj.*only read.*\.glb' scene forest --scale 0.3 -o over.obj
[ -e over.obj ] && complain "a refused scene is there"
refuse 'f.glb.*files to bake' bake f.glb -o ./f.glb
refuse 'f.obj.*\.walk' bake f.glb -o f.obj
expect 1 'nonexistent' scene forest -o /nonexistent/f.glb
expect 2 '--lamps: Only the town has lamps' scene room --lamps -o lit.glb
expect 1 'lit.ostf: .*holds no lamps.*\.glb' scene town --lamps -o lit.ostf
expect 1 'nonexistent' calibrate --quick --plot /nonexistent/p.svg
expect 1 'f.glb is a file' calibrate --state f.glb
expect 1 'f.glb is a file' accuracy f.walk -o f.glb
for option in --ledger --trace --capture; do
  expect 1 "^surefoot: $option .*nonexistent" walk f.walk $virtual --frames 4000000 $option /nonexistent/file
  expect 1 "^surefoot: $option .*reads" walk f.walk $virtual --frames 4000000 $option f.walk
done
expect 2 'seconds and --frames both' compare f.walk --frames 3 --seconds 2
expect 2 'null: The value draws nothing' compare f.walk --backend null
expect 2 'value-frames: Values are weighed against time' compare f.walk --resource triangles --budget 200 --value-frames 5
expect 2 'backend is the same for all walks' compare f.walk --with backend=null
expect 2 'rasterisers is the same for all walks' compare f.walk --with reserve=0,rasterisers=2
expect 2 'selector excludes --with' compare f.walk --selector flat --with reserve=0
expect 2 'resolution: This is no KEY=VALUE' compare f.walk --with resolution
expect 2 "key 'resolutoin' is unknown. Did you mean 'resolution'" compare f.walk --with resolutoin=50
expect 2 'resolution = 120: The value is not allowed. Use a number from 0 to 100' compare f.walk --with hysteresis=1,resolution=120
expect 2 'model names a file' compare f.walk --with model=x.walk
expect 1 "pictures 2: The null backend draws no pictures. Remove --pictures" walk f.walk --backend null --pictures 2
expect 1 '^surefoot: --report .*f.glb is a file' walk f.walk $virtual --frames 4000000 --report f.glb
expect 1 '^surefoot: --snap .*f.glb is a file' walk f.walk --snap f.glb
expect 1 '--capture-frame 9.*5 frames' walk f.walk $virtual --frames 5 --capture n.cap --capture-frame 9
cmp -s f.walk kept.walk || complain "an output replaced the model"
cmp -s f.glb again.glb || complain "an output replaced the scene"
[ -e n.cap ] && complain "a refused capture left a file"
( ulimit -f 40; "$surefoot" walk f.walk $virtual --frames 300 --ledger big.csv --capture small.cap --json >out 2>err; echo $? >rc )
( ulimit -f 40; "$surefoot" scene forest --scale 0.3 -o over.glb 2>/dev/null ) && complain "a .glb that is too large is a success"
[ -e over.glb ] && complain "half a scene is there"
[ "$(cat rc)" = 1 ] || complain "exit $(cat rc), not 1, where the ledger could not be finished"
grep -q 'big.csv.*too large.*ulimit' err || complain "stderr says '$(head -c 300 err)' of a ledger that is too large"
valid_json out || complain "no summary where an output failed"
[ -e small.cap ] || complain "an output that could be written is missing because another could not"
[ -e big.csv ] && complain "half a ledger is there"

# What stdout does not take is said, and is no success; a reader that leaves early is not an error worth a word.
for command in "scene forest --scale 0.1 -o s.glb" "bake f.glb -o s.walk" "inspect f.walk" "inspect f.walk --tree" "effects f.walk" \
    "walk f.walk $virtual --frames 5" "replay c.cap" "--help" "walk --help"; do
  for more in "" --json; do
    [ -n "$more" ] && case $command in *--help) continue ;; esac
    "$surefoot" $command $more >/dev/full 2>err; got=$?
    [ $got -eq 1 ] || complain "exit $got, not 1, on a full stdout: $command $more"
    grep -q 'standard output: The output cannot be written' err || complain "nothing said of a full stdout: $command $more"
    "$surefoot" $command $more 2>err | head -0; got=${PIPESTATUS[0]}
    [ $got -le 1 ] || complain "exit $got where the reader left: $command $more"
    grep -q 'standard output\|terminate' err && complain "said of a reader that left: $command $more: $(cat err)"
  done
done
"$surefoot" inspect f.walk >&- 2>/dev/null && complain "a closed stdout is a success"
"$surefoot" inspect absent.walk 2>/dev/full; [ $? -eq 1 ] || complain "a full stderr is a crash"

# The manual: a page a command, which man takes without a warning, and every option of --help on it.
json manual -o man
for command in $("$surefoot" --help | sed -n '/Subcommands:/,$s/^  \([a-z][a-z-]*\) .*/\1/p'); do
  [ -s "man/surefoot-$command.1" ] || { complain "no manual page of $command"; continue; }
  for option in $("$surefoot" "$command" --help | grep -oE '^  (-[a-z],)?--[a-z-]+' | grep -oE -- '--[a-z-]+'); do
    grep -qF -- "$(sed 's/-/\\-/g' <<<"$option")" "man/surefoot-$command.1" || complain "manual page of $command lacks $option"
  done
done
grep -q 'rate_hz' man/surefoot.toml.5 || complain "surefoot.toml(5) lacks rate_hz"
if command -v groff >/dev/null; then
  for page in man/*; do
    [ -z "$(groff -man -Tutf8 -ww -z "$page" 2>&1)" ] || complain "$page: $(groff -man -Tutf8 -ww -z "$page" 2>&1 | head -3)"
  done
fi
expect 1 '/dev/null/man: The folder cannot be made' manual -o /dev/null/man
expect 1 "-o '': The folder cannot be made" manual -o ''
grep -nE '[a-z")]\.\.( |$)' man/* && complain "a sentence of the manual ends with two full stops"
grep -qx 'surefoot devices list \[OPTION\]\.\.\.' man/surefoot-devices-list.1 || complain "the synopsis of devices list is not what a user types"

# Figures and forms.
json inspect f.walk --tree
grep -q '"parent"' out || complain "inspect --tree --json has no parents"
grep -q '"range"' out && complain "inspect --tree has ranges without an accuracy"
json inspect f.walk --tree --accuracy 500
grep -q '"alpha_rad":3.14159' out && grep -q '"drawn":\[{"from_m":' out || complain "inspect --accuracy has no ranges: $(head -c 900 out)"
"$surefoot" inspect f.walk --tree --accuracy 500 >out 2>err; grep -qE ' from 0 m mesh:[0-9]+, from [0-9.]+ m ' out || complain "inspect --accuracy draws one form at all distances: $(head -3 out)"
expect 2 '--accuracy.*--tree' inspect f.walk --accuracy 500
json inspect kept.walk --map plan.svg
grep -q '"path": "default path' out || complain "the floor plan does not follow the default path: $(cat out)"
[ "$(head -c 5 plan.svg)" = '<svg ' ] && grep -q '</svg>' plan.svg || complain "the floor plan is no picture"
"$surefoot" inspect f.walk --map plan.svg --path none --json >out 2>err; grep -q '"path": "generated tour"' out || complain "--map does not follow --path"
expect 2 'plan.png.*PLAN.svg' inspect f.walk --map plan.png
expect 2 '--path.*--map' inspect f.walk --path none
"$surefoot" replay c.cap >out 2>err; grep -q 'frame 7,' out || complain "replay names another frame than the captured one: $(head -1 out)"
refuse 'best-worst' replay c.cap --selector best-worst
"$surefoot" walk f.walk $virtual --frames 5 >out 2>err
[ "$(cat out err | grep -c 'no cost table')" -eq 1 ] || complain "a missing cost table is not said once"
grep -q '^uncalibrated' out || complain "the figures are not marked as uncalibrated"
grep -q 'not fully real-time: no cost' out err && complain "a missing cost table is no lack of real time"
expect 1 '^surefoot: --strict.*no cost table.*calibrate' walk f.walk --strict --frames 5

# The image cache, counted, and drawn where a device can.
json cache-study flat --frames 6 --birds-eye sheet.png --backend null
grep -q '"boxes": 341' out && grep -q '"not_replaceable"' out || complain "cache-study lacks its counts: $(head -c 300 out)"
grep -q '"ms": null' out && grep -q '"ms_reason": "Nothing is drawn' out || complain "cache-study does not say why it has no times"
grep -q '"ms": [^n]' out && complain "cache-study has times of what it does not draw"
grep -q '"walked_m": [1-9]' out && grep -q '"max_refreshes_of_a_frame"' out || complain "cache-study lacks its way: $(head -c 300 out)"
json cache-study room --frames 2 --pictures views
if grep -q '"ms_reason": null' out; then
  grep -q '"ms": [0-9]' out && grep -q '"full_ms": [0-9]' out && grep -q '"a_picture_an_object"' out || complain "a drawn cache-study lacks times: $(head -c 300 out)"
  [ "$(ls views | grep -c -E '^room-0000[01]-(cache|full|difference|by-object).png$')" -eq 8 ] || complain "cache-study lacks pictures: $(ls views)"
else
  grep -q '"ms": [0-9]' out && complain "cache-study has times of what it does not draw"
fi
expect 1 'folder cannot be made' cache-study flat --frames 2 --pictures sheet.png/folder
expect 2 '--pictures.*draws nothing' cache-study flat --frames 2 --pictures views --backend null
refuse 'vulkan' cache-study flat --backend vulkan
json cache-study flat --frames 1 --backend null
grep -q '"shape_as_published": null' out || complain "cache-study judges one frame"
head -c 4 sheet.png | grep -q PNG || complain "the bird's-eye view is no picture"
refuse 'garden.*flat, forest, zoom, room' cache-study garden
refuse '--frames.*0.* 1 to' cache-study flat --frames 0
refuse '--size abc.* 16 to 16384' cache-study flat --size abc
refuse 'sheet.jpg.*FILE.png' cache-study flat --birds-eye sheet.jpg
expect 1 'nonexistent' cache-study flat --frames 2 --birds-eye /nonexistent/sheet.png

# Paths that are out of all measure.
for row in 1e300,0,0,0,0,0,0,1 1,1e300,0,0,0,0,0,1 1,nan,0,0,0,0,0,1 1,1e999,0,0,0,0,0,1 1,0,0,0,1e300,0,0,1; do
  printf '0,0,0,0,0,0,0,1\n%s\n' "$row" > huge.csv
  expect 1 'huge.csv:2: Column' walk f.walk $virtual --path huge.csv
done
printf '0,0,0,0,0,0,0,1\n9e10,0,0,0,0,0,0,1\n' > long.csv
expect 1 'long.csv.*frames.*--frames' walk f.walk $virtual --path long.csv

# Ctrl-C: one line, what was there is still there, and a walk sums up what ran.
stop_after() { local seconds=$1; shift; "$surefoot" "$@" >out 2>err & local pid=$!; sleep "$seconds"; kill -INT $pid; wait $pid; }
stop_after 1 walk f.walk $virtual --frames 4000000 --ledger stopped.csv; got=$?
[ $got -eq 130 ] || complain "exit $got, not 130, of a stopped walk"
grep -q 'stopped by the user after' err || complain "a stopped walk says '$(head -c 300 err)'"
grep -q 'cut hash' out || complain "a stopped walk does not sum up"
# Whenever it comes: outputs are of the frames that ran, or what was there before.
for after in 0.05 0.1 0.2 0.3 0.5; do
  echo 'of an earlier walk' >earlier.csv
  stop_after $after walk f.walk --backend null --no-fifo --seconds 20 --ledger earlier.csv
  if grep -q 'of an earlier walk' earlier.csv; then
    grep -q 'stopped by the user after [1-9]' err && complain "a walk stopped after $after s says that frames ran, and writes none"
  else
    [ "$(wc -l <earlier.csv)" -gt 1 ] || complain "a walk stopped after $after s replaces a ledger by an empty one: $(cat err)"
  fi
done
for option in --report --ledger --trace --snap --capture --incidents --input; do
  expect 2 "$option.*names nothing" walk f.walk $virtual $option ""
done
"$surefoot" scene town --scale 0.5 -o big.glb >/dev/null
stop_after 0.4 bake big.glb -o f.walk; got=$?
[ $got -eq 130 ] || complain "exit $got, not 130, of a stopped bake: $(cat err)"
cmp -s f.walk kept.walk || complain "a stopped bake changed the model that was there"
stop_after 1 selftest --hard L2 --scale 100; got=$?
[ $got -eq 130 ] || complain "exit $got, not 130, of a stopped selftest: $(cat err)"
stop_after 0.5 cache-study flat --frames 1000000 --birds-eye stopped.png; got=$?
[ $got -eq 130 ] || complain "exit $got, not 130, of a stopped cache-study: $(cat err)"
[ -e stopped.png ] && complain "a stopped cache-study left a picture"
for command in "calibrate --quick --state stopped" "accuracy f.walk --repeats 100 --poses 256 -o stopped"; do
  stop_after 1 $command; got=$?
  grep -qi 'egl\|gl ' err && continue  # no software GL on this machine: nothing to stop
  [ $got -eq 130 ] || complain "exit $got, not 130, of a stopped $command: $(cat err)"
  [ "$(wc -l < err)" -eq 1 ] || complain "not one line of a stopped $command: $(cat err)"
  [ -e stopped ] && complain "a stopped $command left something"
done
ls ./*.tmp 2>/dev/null && complain "something half-written is left"

verdict "the command line"
