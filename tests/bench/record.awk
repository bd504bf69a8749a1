# Makes one line of results.jsonl: awk -f json.awk -f promises.awk -f record.awk, with everything in the environment (RECORD_*), since
# `awk -v` would take backslashes apart. Exit status 2: no such promise, or no number.

# A JSON string, character by character: awks differ in what they make of backslashes in gsub().
function quoted(text,    at, character, out) {
  gsub(/[\001-\037\177]+/, " ", text)
  for (at = 1; at <= length(text); ++at) {
    character = substr(text, at, 1)
    out = out (character == "\"" || character == "\\" ? "\\" : "") character
  }
  return "\"" out "\""
}
function optional(name, text) { return text == "" ? "" : ", \"" name "\": " quoted(text) }
function refuse(what) { print "tests/bench/run: " what > "/dev/stderr"; exit 2 }

BEGIN {
  e = "RECORD_"
  wrong = read_promises(ENVIRON[e "PROMISES"])
  if (wrong != "") refuse(wrong)
  id = ENVIRON[e "PROMISE"]; figure = ENVIRON[e "FIGURE"]
  if (!(id in group_of)) refuse(id ": there is no such promise in tests/bench/promises.tsv")
  if (read_json(figure, values, kinds) != "" || kinds[""] != "number") refuse(id ": the figure " figure " is no number")
  command = ENVIRON[e "COMMAND"] == "" ? command_of[id] : ENVIRON[e "COMMAND"]
  printf "{\"time\": %s, \"commit\": %s", quoted(ENVIRON[e "TIME"]), quoted(ENVIRON[e "COMMIT"])
  printf ", \"host\": {\"cpu\": %s, \"cores\": %d, \"kernel\": %s, \"mesa\": %s}", quoted(ENVIRON[e "CPU"]), ENVIRON[e "CORES"],
    quoted(ENVIRON[e "KERNEL"]), quoted(ENVIRON[e "MESA"])
  printf ", \"promise\": %s, \"scene\": %s, \"figure\": %s, \"unit\": %s", quoted(id), quoted(ENVIRON[e "SCENE"]), figure, quoted(unit_of[id])
  printf ", \"target\": %s, \"bound\": %s, \"holds\": %s", quoted(target_of[id]), quoted(bound_of[id]), holds_in(figure, bound_of[id])
  printf "%s, \"command\": %s", optional("spread", ENVIRON[e "SPREAD"]), quoted(command)
  printf "%s%s%s}\n", optional("note", ENVIRON[e "NOTE"]), optional("why", ENVIRON[e "WHY"]), optional("next", ENVIRON[e "NEXT"])
}
