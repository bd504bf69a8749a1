# Reads promises.tsv: read_promises(file) returns "" or what is wrong, with file:line. Fills order[1..n] with the ids in the order of the
# file, and group_of, unit_of, target_of, bound_of, trend_of, command_of and meaning_of. Beside it: what a bound says of a figure.

function read_promises(file,    line, at, fields, n, where, wrong) {
  split("", order)
  promises = at = 0; wrong = ""
  while ((getline line < file) > 0 && wrong == "") {
    where = file ":" ++at ": "
    n = split(line, fields, "\t")
    if (at == 1) {
      if (line != "promise\tgroup\tunit\ttarget\tbound\ttrend\tcommand\tmeaning") wrong = where "this is not the head line of a table of promises"
    } else if (n != 8) wrong = where "has " n " columns, not 8"
    else if (fields[1] !~ /^[a-z][a-z0-9_]*$/) wrong = where "the id " fields[1] " has other characters than a-z, 0-9 and _"
    else if (fields[1] in group_of) wrong = where "the promise " fields[1] " is there twice"
    else if (!is_bound(fields[5])) wrong = where "the bound " fields[5] " is none of <=N, <N, >=N, >N, ==N, -"
    else if ((fields[2] == "-") != (fields[5] == "-")) wrong = where "a figure without a bound has no group, and one with a bound has one"
    else {
      order[++promises] = fields[1]
      group_of[fields[1]] = fields[2]; unit_of[fields[1]] = fields[3]; target_of[fields[1]] = fields[4]; bound_of[fields[1]] = fields[5]
      trend_of[fields[1]] = fields[6]; command_of[fields[1]] = fields[7]; meaning_of[fields[1]] = fields[8]
    }
  }
  close(file)
  if (at == 0) return file ": cannot be read, or is empty"
  return wrong
}

# Bounds: "<=25", "<2", ">=99.9", "==0"; "-" where there is none.
function is_bound(bound) { return bound == "-" || bound ~ /^(<=|>=|==|<|>)-?[0-9]+(\.[0-9]+)?$/ }

# true, false, or null without a bound
function holds_in(figure, bound,    limit, operator) {
  if (bound == "-") return "null"
  operator = bound; sub(/[-0-9.]+$/, "", operator)
  limit = substr(bound, length(operator) + 1) + 0; figure += 0
  if (operator == "<=") return figure <= limit ? "true" : "false"
  if (operator == ">=") return figure >= limit ? "true" : "false"
  if (operator == "<") return figure < limit ? "true" : "false"
  if (operator == ">") return figure > limit ? "true" : "false"
  return figure == limit ? "true" : "false"
}
