# Read by tests/bench/run: appends figures to a file of JSON lines, and reads what a command printed. Not run by itself.
# shellcheck shell=bash

bench=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

# The commit that is measured; + after it: the tree holds other changes than figures.
current_commit() {
  local commit
  commit=$(git -C "$bench" rev-parse --short=7 HEAD 2>/dev/null) || { echo unknown; return; }
  if [[ -n "$(git -C "$bench" status --porcelain --untracked-files=no -- ':/' ':(exclude,top)tests/bench/results.jsonl' \
    ':(exclude,top)tests/bench/RESULTS.md' ':(exclude,top)tests/bench/history.csv' ':(exclude,top)tests/bench/trend.svg')" ]]; then commit+=+; fi
  echo "$commit"
}

# The host, without its name: for all figures of this run.
read_host() {
  host_cpu=$(sed -n 's/^model name[ \t]*: *//p' /proc/cpuinfo | head -n 1)
  host_cores=$(nproc)
  host_kernel=$(uname -r)
  host_mesa=$(dpkg-query -W -f '${source:Upstream-Version}' libgl1-mesa-dri 2>/dev/null || true)
}

# record OUT PROMISE FIGURE [--scene S] [--spread T] [--note T] [--why T] [--next T] [--command C]: appends one line, and prints it.
# Exit status 2 where there is no such promise, or no number.
record() {
  local out=$1 promise=$2 figure=$3 line status=0
  shift 3
  [[ -n "${host_cpu+read}" ]] || read_host
  local scene='' spread='' note='' why='' next='' command=''
  while (( $# > 1 )); do
    case $1 in
      --scene) scene=$2 ;;
      --spread) spread=$2 ;;
      --note) note=$2 ;;
      --why) why=$2 ;;
      --next) next=$2 ;;
      --command) command=$2 ;;
      *) echo "tests/bench/run: record has no option $1" >&2; return 2 ;;
    esac
    shift 2
  done
  if (( $# > 0 )); then echo "tests/bench/run: record: $1 wants a value" >&2; return 2; fi
  line=$(RECORD_PROMISES="$bench/promises.tsv" RECORD_TIME=$(date -u +%FT%TZ) RECORD_COMMIT=${run_commit:-$(current_commit)} \
    RECORD_CPU=${host_cpu:-unknown} RECORD_CORES=$host_cores RECORD_KERNEL=$host_kernel RECORD_MESA=$host_mesa \
    RECORD_PROMISE=$promise RECORD_FIGURE=$figure RECORD_SCENE=$scene RECORD_SPREAD=$spread RECORD_NOTE=$note RECORD_WHY=$why \
    RECORD_NEXT=$next RECORD_COMMAND=$command \
    LC_ALL=C awk -f "$bench/json.awk" -f "$bench/promises.awk" -f "$bench/record.awk" </dev/null) || status=$?
  if (( status != 0 )); then return "$status"; fi
  printf '%s\n' "$line" | tee -a "$out"
}

# read_values FILE: what a command printed as JSON, into the map `values`: values[frame_ms.p99].
declare -A values
read_values() {
  local path value
  values=()
  while IFS=$'\t' read -r path value; do values[${path:-.}]=$value; done \
    < <(LC_ALL=C awk -f "$bench/json.awk" -f "$bench/flatten.awk" "$1" 2>/dev/null || true)
  (( ${#values[@]} > 0 ))
}

# value PATH: fails, and says so, where there is none or it is null.
value() {
  local found=${values[$1]:-null}
  if [[ $found == null ]]; then echo "tests/bench/run: no value $1 was printed" >&2; return 1; fi
  echo "$found"
}

# sum EXPRESSION [DIGITS=4]: a figure out of others, with so many significant digits.
sum() { awk "BEGIN { x = $1; d = ${2:-4}; if (x >= 10 ^ d) printf \"%.0f\", x; else printf \"%.\" d \"g\", x }"; }
