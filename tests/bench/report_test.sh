#!/usr/bin/env bash
# tests/bench/report and tests/bench/run record on made-up figures: the newest wins, a missed target is shown as missed with its
# reason, and what is broken is named with file and line.
# usage: report_test.sh SOURCE_DIR
set -u
bench=$1/tests/bench
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
failures=0
fault() { echo "FAILED: $1"; failures=$((failures + 1)); }
report() { "$bench/report" --promises promises.tsv --from figures.jsonl --to made "$@" >output 2>&1; }
has_text() { grep -qF -- "$2" "$1" || { fault "$3: $1 does not say: $2"; cat "$1"; }; }
lacks_text() { ! grep -qF -- "$2" "$1" || fault "$3: $1 says: $2"; }

printf '%s\t%s\t%s\t%s\t%s\t%s\t%s\t%s\n' promise group unit target bound trend command meaning \
  late Frames misses '≤ 2' '<=2' yes 'run late' 'Late frames.' \
  used Frames % '≥ 75 %' '>=75' - 'run used' 'Used time.' \
  never Frames ms '≤ 1 ms' '<=1' - 'run never' 'Nobody measured it.' \
  beside - ms - - - 'run beside' 'A figure without a target.' >promises.tsv
figure() { # TIME PROMISE SCENE FIGURE BOUND HOLDS [MORE]
  printf '{"time": "%s", "commit": "abc1234", "host": {"cpu": "A CPU", "cores": 2, "kernel": "6.1", "mesa": "22.3.6"}, "promise": "%s", "scene": "%s", "figure": %s, "unit": "u", "target": "t", "bound": "%s", "holds": %s, "command": "c"%s}\n' "$@"
}

# ---- the newest wins, whatever the order of the lines; a missed target is shown with why and next ----
{
  figure 2026-01-02T00:00:00Z late town 1 '<=2' true ''
  figure 2026-01-01T00:00:00Z late town 9 '<=2' false ''
  figure 2026-01-01T00:00:00Z late wood 3 '<=2' false ', "why": "a | slow disk", "next": "a \"fast\" one"'
  figure 2026-01-03T00:00:00Z late wood 4.5 '<=2' false ''
  figure 2026-01-01T00:00:00Z used '' 80 '>=75' true ', "note": "a, b"'
  figure 2026-01-01T00:00:00Z beside '' 5 - null ''
} >figures.jsonl
report || { fault "good figures are refused"; cat output; }
has_text made/RESULTS.md "| town: 1 | yes |" "the newest"
lacks_text made/RESULTS.md "town: 9" "the newest"
has_text made/RESULTS.md "| **wood: 4.5** | **no** |" "a missed target"
has_text made/RESULTS.md '* late (≤ 2) wood: 4.5. Why: a | slow disk Next: a "fast" one' "a missed target keeps its last reason"
has_text made/RESULTS.md "**1 of 2 promises hold** in every scene; 2 of 3 newest figures hold." "the count"
has_text made/RESULTS.md "No figure yet: never." "a promise without a figure"
lacks_text made/RESULTS.md "beside" "a figure without a target"
has_text made/history.csv '"a, b"' "CSV"
has_text made/history.csv 'late,wood,3,' "old figures stay in the CSV"
(( $(wc -l <made/history.csv) == 7 )) || fault "the CSV has a row for each figure"
has_text made/trend.svg "late, target" "the trend"
has_text made/trend.svg "2 of 3, 67 %" "the trend"

# ---- scenes of one day share a row, whatever their commits ----
cp figures.jsonl before.jsonl
{
  figure 2026-01-06T00:00:00Z late hill 1 '<=2' true ''
  figure 2026-01-06T01:00:00Z late lake 2 '<=2' true '' | sed 's/abc1234/def5678/'
  figure 2026-01-06T02:00:00Z late moor 2 '<=2' true ''
} >>figures.jsonl
report || { fault "figures of two commits are refused"; cat output; }
has_text made/RESULTS.md "hill: 1, lake: 2, moor: 2 | yes | abc1234, def5678 |" "each commit once, in the order of the scenes"
mv before.jsonl figures.jsonl
report || fault "making it again"

# ---- a figure without a scene gives way to newer ones of scenes, and stays beside older ones ----
cp figures.jsonl before.jsonl
figure 2026-01-08T00:00:00Z late '' 7 '<=2' false '' >>figures.jsonl
report || { fault "a figure without a scene is refused"; cat output; }
has_text made/RESULTS.md "**7**" "the newest without a scene stays"
figure 2026-01-09T00:00:00Z late hill 1 '<=2' true '' >>figures.jsonl
report || { fault "a newer scene is refused"; cat output; }
lacks_text made/RESULTS.md "**7**" "a newer scene takes its place"
has_text made/history.csv "late,,7," "it stays in the CSV"
mv before.jsonl figures.jsonl
report || fault "making it again"

# ---- --check ----
report --check || { fault "--check refuses what was just made"; cat output; }
echo >>made/RESULTS.md
if report --check; then fault "--check passes a page that was edited"; fi
has_text output "RESULTS.md" "--check"
report || fault "making it again"
figure 2026-01-04T00:00:00Z late town 2 '<=2' true '' >>figures.jsonl
if report --check; then fault "--check passes although a figure was added"; fi
report || fault "making it again"

# ---- broken lines are named, and what was made stays ----
cp -r made kept
cp figures.jsonl good.jsonl
refused() { # WHAT LINE WORDS
  { cat good.jsonl; printf '%s\n' "$2"; } >figures.jsonl
  if report; then fault "$1 is not refused"; return; fi
  has_text output "figures.jsonl:8: " "$1"
  has_text output "$3" "$1"
  diff -r made kept >/dev/null || fault "$1: the files were changed"
}
good=$(figure 2026-01-05T00:00:00Z late town 2 '<=2' true '')
refused "a cut line" "${good:0:60}" "the line ends"
refused "no JSON" "late 2" "no value"
refused "an empty line" "" "the line ends too early"
refused "a list" "[1]" "a line is one object"
refused "more after the object" "$good $good" "more follows"
refused "a name twice" "${good/\"unit\": \"u\"/\"figure\": 1}" "twice"
refused "an unknown promise" "${good/late/lte}" "there is no promise lte"
refused "an unknown field" "${good/unit/unti}" "there is no field unti"
refused "a missing field" "${good/, \"command\": \"c\"/}" "command is missing"
refused "a figure in quotes" "${good/\"figure\": 2/\"figure\": \"2\"}" "figure is missing"
refused "a figure that is no number" "${good/\"figure\": 2/\"figure\": nan}" "no value"
refused "a verdict that its bound denies" "${good/true/false}" "holds is false"
refused "a time that is none" "${good/T00:00:00Z/}" "is not as"
refused "a commit that is none" "${good/abc1234/main}" "commit"
refused "a bound that is none" "${good/<=2/about 2}" "bound"

# ---- no figures, no file, a broken table of promises, wrong use ----
: >figures.jsonl
report || { fault "an empty file is refused"; cat output; }
has_text made/RESULTS.md "**0 of 0 promises hold**" "an empty file"
has_text made/RESULTS.md "No figure yet: late, used, never." "an empty file"
has_text made/trend.svg "no figure yet" "an empty file"
rm figures.jsonl
if report; then fault "a missing file is not refused"; fi
has_text output "cannot be read" "a missing file"
cp good.jsonl figures.jsonl
cp promises.tsv promises.good
printf 'late\tFrames\tms\t1\t<=1\t-\tc\tm\n' >>promises.tsv
if report; then fault "a promise that is there twice is not refused"; fi
has_text output "promises.tsv:6: the promise late is there twice" "a promise twice"
cp promises.good promises.tsv
report --nonsense; (( $? == 2 )) || fault "a wrong argument is not wrong use"
report --from; (( $? == 2 )) || fault "an option without its value is not wrong use"
"$bench/report" --help | grep -q '^Usage' || fault "--help"

# ---- the page is held to its size ----
awk 'BEGIN { for (i = 1; i <= 190; ++i) printf "p%d\tFrames\tms\t1\t<=1\t-\tc\tm\n", i }' >>promises.tsv
for i in {1..190}; do figure 2026-01-01T00:00:00Z "p$i" '' 1 '<=1' true ''; done >figures.jsonl
if report; then fault "a page of more than 180 lines is not refused"; fi
has_text output "180 at most" "a long page"

# ---- record ----
record() { "$bench/run" record "$@" --out recorded.jsonl >output 2>&1; }
record gate_minutes 11.4 --scene 'a "scene"' --note 'back\slash and	tab' || { fault "record fails"; cat output; }
record gate_minutes 13 --why 'a reason' || { fault "record of a missed target fails"; cat output; }
"$bench/report" --from recorded.jsonl --to recorded >output 2>&1 || { fault "what record wrote is refused"; cat output; }
has_text recorded/RESULTS.md 'a "scene": 11.4' "record"
has_text recorded/history.csv 'back\slash and tab' "record"
has_text recorded/RESULTS.md '* gate_minutes (≤ 12 min) 13. Why: a reason' "record"
has_text recorded.jsonl '"holds": true' "record"
has_text recorded.jsonl '"holds": false' "record"
lacks_text recorded.jsonl "$(hostname)" "record names the host"
before=$(cksum <recorded.jsonl)
wrong() { record "$@"; (( $? == 2 )) || fault "record $* is not wrong use"; }
wrong no_such_promise 1
wrong gate_minutes fast
wrong gate_minutes
wrong gate_minutes 1 2
wrong gate_minutes 1 --nonsense x
wrong gate_minutes 1 --note
[[ "$(cksum <recorded.jsonl)" == "$before" ]] || fault "a refused figure was written"
"$bench/run" nonsense >output 2>&1; (( $? == 2 )) || fault "an unknown group is not wrong use"
"$bench/run" --help | grep -q '^Usage' || fault "--help of run"

echo "$failures failures"
(( failures == 0 ))
