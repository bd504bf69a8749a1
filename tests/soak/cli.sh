#!/usr/bin/env bash
# The command line's contract for `surefoot soak`; and that its load ends with it, however it ends.
# usage: cli.sh SUREFOOT
set -u
surefoot=$(realpath "$1")
source "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/../contract.sh"
# A small room, and not much more than what a verdict needs: the length is what costs.
"$surefoot" scene room --scale 0.2 -o f.glb >/dev/null && "$surefoot" bake f.glb -o f.walk >/dev/null 2>&1 || complain "no model"
virtual="--clock virtual --backend null"
# The load names its processes so; those of other soaks on this machine are not ours.
load_of() { pgrep -x sf-load -s "$1" 2>/dev/null | wc -l; }

# A virtual soak holds, and leaves its page and figures.
expect 0 '' soak f.walk $virtual --seconds 780 --rate 60 --report page
grep -q 'the verdict holds' out || complain "the table has no verdict: $(cat out)"
[ -s page/index.html ] && valid_json page/soak.json || complain "no page"
expect 0 '' soak f.walk $virtual --seconds 780 --json; valid_json out || complain "soak --json is not one object"
grep -q '"verdict": "holds"' out || complain "no verdict in the JSON"
expect 0 '' soak --help; grep -q 'surefoot soak' out || complain "no example"

mean_triangles() { "$surefoot" soak f.walk $virtual --seconds 5 "$@" --json 2>/dev/null | grep -A1 '"triangles"' | tail -1; }
[ "$(mean_triangles)" != "$(mean_triangles --lift 500)" ] || complain "--lift lifts nothing"

# Wrong use is 2, bad input 1, before anything is loaded; a verdict that does not hold is 1.
expect 2 'no load .disk.*devices' soak f.walk $virtual --mix cpu,disk
expect 2 'both set the length' soak f.walk $virtual --hours 1 --seconds 5
expect 2 'seconds' soak f.walk $virtual --seconds 0
expect 2 'strict.*real clock' soak f.walk $virtual --strict
expect 1 'absent.walk' soak absent.walk $virtual
expect 1 'report.*f.glb' soak f.walk $virtual --report f.glb
expect 1 'some rules cannot be judged' soak f.walk $virtual --seconds 5
grep -q 'not judged' out || complain "what was too short is not said"

# On the real clock, in a session of its own: stopped by Ctrl-C it sums up and ends its load; killed, the load ends by itself.
load_came() { [ "$(load_of $leader)" -ge 3 ]; }
load_is_gone() { [ "$(load_of $leader)" -eq 0 ]; }
soak="$surefoot soak f.walk --backend null --seconds 300 --no-control --mix cpu,forks,memory"
setsid $soak >out 2>err & leader=$!
eventually 10 load_came || complain "no load came: $(cat err)"
kill -INT $leader; wait $leader; got=$?
[ $got -eq 130 ] || complain "exit $got, not 130, of a stopped soak: $(cat err)"
grep -q 'stopped by the user after' err || complain "a stopped soak says '$(head -c 300 err)'"
grep -q '^grid *holds' out || complain "a stopped soak is not judged: $(cat out)"
[ "$(load_of $leader)" -eq 0 ] || complain "load goes on after a stopped soak"
setsid $soak >out 2>err & leader=$!
eventually 10 load_came || complain "no load came the second time"
kill -KILL $leader; wait $leader 2>/dev/null
eventually 5 load_is_gone || complain "load goes on though its soak was killed"
verdict "soak"
