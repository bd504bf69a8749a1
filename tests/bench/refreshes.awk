# Reads the ledger of a walk with jumps, and prints a JSON object: how long making pictures of the image cache took, as predicted
# and corrected, outside of the two seconds after a jump and within them. A jump is a step of over 2 m. A control's frames do not
# count: the walk stands still there.
# awk -v period_ms=33.333 -f refreshes.awk LEDGER.csv

BEGIN { FS = ","; after_jump = 2000 / period_ms }
NR == 1 { for (i = 1; i <= NF; ++i) at[$i] = i; next }
$at["control"] == 1 { next }
{
  step = frames++ == 0 ? 1e9 : sqrt(($at["x"] - x) ^ 2 + ($at["y"] - y) ^ 2 + ($at["z"] - z) ^ 2)
  x = $at["x"]; y = $at["y"]; z = $at["z"]
  if (step > 2) { since = 0; if (frames > 1) ++jumps }
  us = $at["captures_us"] * $at["correction"]
  made += $at["pictures_made"]
  if (since++ >= after_jump) { outside[++outsides] = us; next }
  ++within
  share = $at["budget_us"] > 0 ? us / $at["budget_us"] : 0
  if (share > max_share) max_share = share
  if (us > max_us) max_us = us
  if ($at["own_miss"] == 1) ++own
}
# The value below which a share of a list lies.
function quantile(list, n, share,    i, j, t, gap) {
  for (gap = int(n / 2); gap > 0; gap = int(gap / 2))
    for (i = gap + 1; i <= n; ++i) {
      t = list[i]
      for (j = i; j > gap && list[j - gap] > t; j -= gap) list[j] = list[j - gap]
      list[j] = t
    }
  i = int(share * n + 0.999999)
  return n == 0 ? 0 : list[i < 1 ? 1 : i > n ? n : i]
}
END {
  if (frames == 0) { print "refreshes.awk: the ledger has no frame of a walk" > "/dev/stderr"; exit 1 }
  p99 = quantile(outside, outsides, 0.99)
  printf "{\"frames\": %d, \"jumps\": %d, \"pictures_made\": %d, \"frames_outside\": %d, \"p99_us\": %.1f, \"p99_of_period\": %.5f, ", frames,
    jumps, made, outsides, p99, p99 / (1000 * period_ms)
  printf "\"frames_after_jumps\": %d, \"max_after_jumps_us\": %.1f, \"max_after_jumps_of_budget\": %.5f, \"own_misses_after_jumps\": %d}\n", within,
    max_us, max_share, own
}
