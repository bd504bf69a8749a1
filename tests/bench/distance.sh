# The group `distance` of tests/bench/run, which sources this: in real time, the accuracy of the worst object in each frame, by a budget and
# by a fixed angle that takes as long. Neither has the check in the frame (--no-check): it bounds the time of a fixed angle at any accuracy,
# and its stand-ins have none. Costs are those of the state folder, fitted or not: p99 is made equal, whatever was predicted. The budget is
# 0.6 of the period. Where frames take nearly all of it, preparing starves, and p99 of equal walks differs by a third.
# shellcheck shell=bash
# shellcheck disable=SC2034,SC2154 # work, surefoot, state, path, build: of run

distance_frames=900 distance_turns=3

# One walk in real time. Sets p99 of its frames, ms; the ledger is WORK/distance-LABEL.csv.
distance_walk() { # LABEL NAME RATE OPTIONS...
  local label=distance-$1 name=$2 rate=$3
  shift 3
  measure "$label" "$surefoot" walk "$work/$name.walk" "${path[@]}" --rate "$rate" --frames "$distance_frames" --resolution 100 \
    --no-check --rest-after 0 --state "$state" --ledger "$work/$label.csv" "$@" --json || return 1
  p99=$(value frame_ms.p99) missed=$(value misses) steal=$(rounded steal_ms)
}

# A budget between the coarsest and full detail, where time depends on the angle: the geometric mean of both medians. It is 0.6 of the
# period. Sets rate. (At 60 Hz the hospital takes 8.4 ms at 10 rad^-1 and 10.0 at 5000: no angle could be found by its time.)
distance_rate() { # NAME
  local coarsest
  path_of "$1"
  measure "distance coarsest $1" "$surefoot" walk "$work/$1.walk" "${path[@]}" --selector distance --accuracy 2 --late float --no-check \
    --rest-after 0 --resolution 100 --rate 10 --frames 60 --state "$state" --json || return 1
  coarsest=$(value frame_ms.p50)
  measure "distance full detail $1" "$surefoot" walk "$work/$1.walk" "${path[@]}" --selector flat --late float --no-check --rest-after 0 \
    --resolution 100 --rate 10 --frames 60 --state "$state" --json || return 1
  rate=$(awk "BEGIN { printf \"%.3f\", 600 / sqrt($coarsest * $(value frame_ms.p50)) }")
}

# distance_fit WANTED: of the lines "accuracy p99" on stdin the accuracy at which p99 is WANTED ms, at least 2 rad^-1, by a line on
# logarithms; the line's p99 there; its standard error in per cent. A stall of the machine makes a walk's p99 longer by a third and
# more, so slope and height are medians (Theil 1950, Sen 1968), and so is the error.
distance_fit() {
  awk -v wanted="$1" '
    function middle(list, n,    i, j, t) {
      for (i = 2; i <= n; ++i) { t = list[i]; for (j = i - 1; j > 0 && list[j] > t; --j) list[j + 1] = list[j]; list[j + 1] = t }
      return n % 2 ? list[(n + 1) / 2] : (list[n / 2] + list[n / 2 + 1]) / 2
    }
    { x[NR] = log($1); y[NR] = log($2) }
    END {
      for (i = 1; i <= NR; ++i) for (j = i + 1; j <= NR; ++j) if (x[j] != x[i]) slopes[++count] = (y[j] - y[i]) / (x[j] - x[i])
      b = middle(slopes, count)
      for (i = 1; i <= NR; ++i) heights[i] = y[i] - b * x[i]
      a = middle(heights, NR)
      for (i = 1; i <= NR; ++i) { rest = y[i] - a - b * x[i]; rests[i] = rest < 0 ? -rest : rest; mean += x[i] / NR }
      for (i = 1; i <= NR; ++i) sxx += (x[i] - mean) ^ 2
      at = b > 0.02 ? (log(wanted) - a) / b : log(2)
      if (at < log(2)) at = log(2)
      # 1.4826: from the median of what is left to a deviation. 1.25: a median is known less well than a mean.
      printf "%.4g %.4g %.3g\n", exp(at), exp(a + b * at), 100 * 1.25 * 1.4826 * middle(rests, NR) * sqrt(1 / NR + (at - mean) ^ 2 / sxx)
    }'
}

# The accuracy at which `distance` takes about $1 ms (p99). From 4 rad^-1 up until two walks take over 1.15 times as long; then by a line
# through the last five. Sets accuracy.
distance_near() { # P99 NAME RATE
  local wanted=$1 longer=0 points=$work/distance-points
  : >"$points"
  for accuracy in 4 7.2 13 23 42 75 136 245 441 794 1429 2572; do
    distance_walk "$2-near" "$2" "$3" --selector distance --accuracy "$accuracy" || return 1
    echo "$accuracy $p99" >>"$points"
    echo "tests/bench/run: $2: distance at $accuracy rad^-1 has p99 $p99 ms, wanted $wanted" >&2
    if awk "BEGIN { exit !($p99 > 1.15 * $wanted) }"; then longer=$((longer + 1)); fi
    if (( longer == 2 )); then break; fi
  done
  read -r accuracy _ < <(tail -5 "$points" | distance_fit "$wanted")
}

# A line through nine angles near $accuracy, and through those of distance_near that are at most five times as wide or narrow: over a
# narrow range the machine's changes are larger than those of the angle. Sets accuracy to where its p99 is $1 ms, and line_p99 and
# line_error to its p99 there and the standard error in per cent.
distance_line() { # P99 NAME RATE
  local wanted=$1 factor points=$work/distance-points near=$accuracy at
  for factor in 0.6 0.7 0.8 0.9 1 1.12 1.25 1.42 1.65; do
    at=$(awk "BEGIN { printf \"%.4g\", $accuracy * $factor }")
    distance_walk "$2-line" "$2" "$3" --selector distance --accuracy "$at" || return 1
    echo "$at $p99" >>"$points"
  done
  read -r accuracy line_p99 line_error < <(awk -v near="$near" '$1 <= 5 * near && $1 >= near / 5' "$points" | distance_fit "$wanted")
  echo "tests/bench/run: $2: by a line distance has p99 $line_p99 ms at $accuracy rad^-1, +- $line_error %; wanted $wanted" >&2
}

# distance_figures LABEL: median and least of the frames' accuracies, and how many frames are exact.
distance_figures() {
  awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) at[$i] = i; next }
    { a = $at["accuracy"]; if (a == "inf" || a == "") { ++exact; next } print a > "/dev/stderr" }
    END { print exact + 0 }' "$work/distance-$1.csv" 2>"$work/distance-accuracies" >"$work/distance-exact"
  sort -g "$work/distance-accuracies" | awk -v exact="$(cat "$work/distance-exact")" '{ all[NR] = $1 }
    END { if (NR == 0) print "inf inf", exact; else print all[int((NR + 1) / 2)], all[1], exact }'
}

# Pictures of both, every two seconds, against full detail at the same pose: no promise.
distance_pictures() { # NAME RATE: the walks of the last turn again, with pictures; prints words for the note
  local which at every words='' options=()
  every=$(awk "BEGIN { printf \"%.0f\", 2 * $2 }")
  for which in budget angle; do
    options=("${budget[@]}")
    [[ $which == budget ]] || options=(--selector distance --accuracy "$accuracy")
    at=$work/distance-$1-$which
    rm -rf "$at"
    mkdir -p "$at"
    distance_walk "$1-pictures" "$1" "$2" "${options[@]}" --snap "$at/walk" --every "$every" || return 1
    mv "$work/distance-$1-pictures.csv" "$at/ledger.csv"
    beside_full_detail "distance $1 $which" "$at" "${path[1]:-$work/$1.path.csv}" "${path[3]:-0}" "$2" "$every" "$surefoot" "$work/$1.walk" \
      "$state" || return 1
    words+="${words:+, }$which $(rounded psnr_db) dB and FLIP $(rounded flip)"
  done
  echo "$words"
}

# Both in turns, with distance_scene's budget. Fills medians and worsts, a ratio a turn, the p99 of each, and the words of the last turn.
distance_in_turns() { # NAME RATE
  local turn ours theirs
  medians=() worsts=() our_p99=() their_p99=() times=''
  for (( turn = 1; turn <= distance_turns; ++turn )); do
    distance_walk "$1-budget" "$1" "$2" "${budget[@]}" || return 1
    our_p99+=("$p99")
    times+="${times:+; }$(sum "$p99" 3) ($missed missed, $steal ms stolen) and "
    distance_walk "$1-angle" "$1" "$2" --selector distance --accuracy "$accuracy" || return 1
    their_p99+=("$p99")
    times+="$(sum "$p99" 3) ($missed, $steal)"
    read -r -a ours <<<"$(distance_figures "$1-budget")"
    read -r -a theirs <<<"$(distance_figures "$1-angle")"
    if [[ ${ours[0]} == inf || ${theirs[0]} == inf ]]; then
      echo "tests/bench/run: $1: every frame of a walk is exact" >&2
      failed=1
      return 1
    fi
    medians+=("$(awk "BEGIN { printf \"%.3f\", ${ours[0]} / ${theirs[0]} }")") worsts+=("$(awk "BEGIN { printf \"%.3f\", ${ours[1]} / ${theirs[1]} }")")
    words="Last turn: median ${ours[0]} against ${theirs[0]} rad^-1, worst frame ${ours[1]} against ${theirs[1]}, exact frames ${ours[2]} and ${theirs[2]}"
  done
}

distance_scene() { # NAME RATE
  local name=$1 rate=$2 try pictures medians worsts our_p99 their_p99 times wanted words='' first=() line_p99 line_error
  path_of "$name"
  local budget=(--selector curve-budget --budget "$(awk "BEGIN { printf \"%.4g\", 0.6 * 1000 / $rate }")")
  for try in 1 2 3; do
    distance_walk "$name-first" "$name" "$rate" "${budget[@]}" || return 0
    first+=("$p99")
  done
  distance_near "$(middle_of "${first[@]}")" "$name" "$rate" || return 0
  distance_line "$(middle_of "${first[@]}")" "$name" "$rate" || return 0
  distance_in_turns "$name" "$rate" || return 0
  wanted=$(middle_of "${first[@]}" "${our_p99[@]}")
  # Where the angle's walks take longer, up to a quarter, they may: it has more time, so the ratios are too small.
  if ! awk -v line="$line_p99" -v wanted="$wanted" -v walks="$(middle_of "${their_p99[@]}")" -v error="$line_error" -v at="$accuracy" '
      function near(a, b, by) { return a / b <= by && b / a <= by }
      BEGIN { exit !((at <= 2 && walks > wanted) || (near(line, wanted, 1.05) && walks >= wanted / 1.1 && walks <= 1.25 * wanted && error <= 5)) }'; then
    echo "tests/bench/run: $name: p99 of the budget's six walks is $wanted ms, of the angle $line_p99 (+- $line_error %) by its line; in turns: $times" >&2
    failed=1
    return 0
  fi
  pictures=$(distance_pictures "$name" "$rate") || { pictures="none"; failed=1; }
  keep distance_median "$(middle_of "${medians[@]}")" --scene "$name" --spread "$(min_and_max "${medians[@]}")" \
    --note "$words. p99 of the budget's six walks $wanted ms, of the angle by its line $line_p99 (+- $line_error %); in turns: $times; at $rate Hz. Pictures: $pictures."
  keep distance_worst "$(middle_of "${worsts[@]}")" --scene "$name" --spread "$(min_and_max "${worsts[@]}")"
}
