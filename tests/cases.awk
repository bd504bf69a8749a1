# Sums up what GoogleTest wrote as XML: cases that ran, passed, failed and were skipped, with the reasons.
# usage: awk -f cases.awk FILE.xml...    prints "cases PASSED FAILED SKIPPED", then a line a reason: "skip SUITE.CASE: REASON"
function value(name,    at, rest) {
  at = index($0, " " name "=\"")
  if (at == 0) return ""
  rest = substr($0, at + length(name) + 3)
  return substr(rest, 1, index(rest, "\"") - 1)
}
/<testcase / {
  case_name = value("classname") "." value("name")
  result = value("result")
  if (result == "skipped") { ++skipped; ++cases_in[FILENAME] }
  else if (result == "completed") { ++passed; ++cases_in[FILENAME] }
}
/<failure / { if (case_name != failed_name) { ++failed; --passed; failed_name = case_name } }
/<skipped/ {
  reason = value("message")
  sub(/^[^&]*&#x0A;/, "", reason)
  gsub(/&#x0A;/, " ", reason); gsub(/&apos;/, "'", reason); gsub(/&quot;/, "\"", reason); gsub(/&amp;/, "\\&", reason)
  if (reason != "") reasons[++n] = "skip " case_name ": " reason
}
END {
  for (i = 1; i < ARGC; ++i) if (!(ARGV[i] in cases_in)) empty = empty " " ARGV[i]
  printf "cases %d %d %d\n", passed, failed, skipped
  for (i = 1; i <= n; ++i) print reasons[i]
  if (empty != "") print "empty" empty
}
