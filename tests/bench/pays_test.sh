#!/usr/bin/env bash
# tests/bench/pays.awk on made-up points: all three panels, where lines cross 1, the order of points, and what is refused.
# usage: pays_test.sh SOURCE_DIR
set -u
bench=$1/tests/bench
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
failures=0
fault() { echo "FAILED: $1"; failures=$((failures + 1)); }
draw() { LC_ALL=C awk -f "$bench/svg.awk" -f "$bench/pays.awk" -v to=chart.svg points.csv >table.md 2>errors; }
has_text() { grep -qF -- "$2" "$1" || { fault "$3: $1 does not say: $2"; cat "$1"; }; }

good='# panel,line,x,ratio,least,greatest,cpu_ms,cpu_ms_without,pictures,made
speed,flat,4,1.5,1.4,1.6,150,100,9,1
speed,flat,1,0.5,0.4,0.6,50,100,9,1
speed,"a<b",1,0.9,0.8,1.0,90,100,9,1
overdraw,dear,2,0.25,0.2,0.3,25,100,9,1
overdraw,cheap,2,1.25,1.2,1.3,125,100,0,0'
printf '%s\n' "$good" >points.csv
draw || { fault "good points are refused"; cat errors; }
has_text table.md "| speed, m/s | flat | 1: 0.50, 4: 1.50 | 100, 50; 100, 150 | crosses 1 at 2 |" "points are sorted, and 1 is crossed in the logarithmic middle"
has_text table.md "| dear | 2: 0.25 | 100, 25 | below 1 at all points |" "a line below 1"
has_text table.md "| cheap | 2: 1.25 | 100, 125 | never below 1 |" "a line above 1"
has_text chart.svg "flat: crosses 1 at 2<" "the chart"
has_text chart.svg "a&lt;b" "names are escaped"
has_text chart.svg "speed of the eye, m/s" "an axis has its unit"
has_text chart.svg "not measured yet" "the panel without points"
has_text chart.svg "</svg>" "the chart is whole"
[[ "$(grep -c '<circle' chart.svg)" == 5 ]] || fault "a circle for each point"
[[ "$(grep -c 'stroke="#222"' chart.svg)" == 3 ]] || fault "the line at 1 in each panel"

refused() { # WHAT LINE WORDS
  printf '%s\n%s\n' "$good" "$2" >points.csv
  if draw; then fault "$1 is not refused"; return; fi
  has_text errors "points.csv:7: $3" "$1"
}
refused "a missing column" "speed,flat,4,1.5,1.4,1.6,150,100,9" "has 9 columns"
refused "an unknown panel" "weight,flat,4,1.5,1.4,1.6,150,100,9,1" "there is no panel weight"
refused "no number" "speed,flat,4,nan,1.4,1.6,150,100,9,1" "nan is no number"
refused "no speed" "speed,flat,0,1.5,1.4,1.6,150,100,9,1" "x and ratio are above 0"
refused "a ratio outside of its spread" "speed,flat,4,1.7,1.4,1.6,150,100,9,1" "the ratio is outside"
echo "# nothing" >points.csv
if draw; then fault "no points are not refused"; fi
has_text errors "there is no point" "no points"

echo "$failures failures"
(( failures == 0 ))
