# Reads JSON in awk: read_json(text, values, kinds) returns "" or what is wrong. A value stands under its path: values["host.cores"],
# values["points.0.cost_us"]; kinds[path] is string, number, true, false, null, object or array. Needs LC_ALL=C: one character, one byte.

function read_json(text, values, kinds) {
  split("", values); split("", kinds)
  json_rest = text; json_error = ""
  json_value("", values, kinds)
  json_skip_space()
  if (json_error == "" && json_rest != "") json_fault("more follows after the value: " json_rest)
  return json_error
}

function json_fault(what) {
  if (json_error == "") json_error = substr(what, 1, 80)
  json_rest = ""
}

function json_skip_space() { if (json_rest ~ /^[ \t\r\n]/) sub(/^[ \t\r\n]+/, "", json_rest) }

function json_value(path, values, kinds,    first) {
  json_skip_space()
  first = substr(json_rest, 1, 1)
  if (first == "{") json_object(path, values, kinds)
  else if (first == "[") json_array(path, values, kinds)
  else if (first == "\"") { values[path] = json_string(); kinds[path] = "string" }
  else if (match(json_rest, /^(true|false|null)/)) { values[path] = kinds[path] = json_take(RLENGTH) }
  else if (match(json_rest, /^-?(0|[1-9][0-9]*)(\.[0-9]+)?([eE][-+]?[0-9]+)?/)) { values[path] = json_take(RLENGTH); kinds[path] = "number" }
  else if (json_rest == "") json_fault("the line ends too early")
  else json_fault("no value: " json_rest)
}

function json_take(length_of,    taken) {
  taken = substr(json_rest, 1, length_of)
  json_rest = substr(json_rest, length_of + 1)
  return taken
}

function json_expect(character) {
  json_skip_space()
  if (substr(json_rest, 1, 1) == character) { json_take(1); return 1 }
  json_fault(json_rest == "" ? "the line ends too early" : "expected " character " before " json_rest)
  return 0
}

function json_object(path, values, kinds,    name, inner) {
  kinds[path] = "object"; values[path] = ""
  json_take(1); json_skip_space()
  if (substr(json_rest, 1, 1) == "}") { json_take(1); return }
  while (json_error == "") {
    json_skip_space()
    if (substr(json_rest, 1, 1) != "\"") { json_fault(json_rest == "" ? "the line ends too early" : "no name: " json_rest); return }
    name = json_string()
    inner = path == "" ? name : path "." name
    if (inner in kinds) { json_fault("twice the name " name); return }
    if (!json_expect(":")) return
    json_value(inner, values, kinds)
    json_skip_space()
    if (substr(json_rest, 1, 1) == ",") json_take(1)
    else { json_expect("}"); return }
  }
}

function json_array(path, values, kinds,    at) {
  kinds[path] = "array"; values[path] = 0
  json_take(1); json_skip_space()
  if (substr(json_rest, 1, 1) == "]") { json_take(1); return }
  for (at = 0; json_error == ""; ++at) {
    json_value((path == "" ? at : path "." at), values, kinds)
    values[path] = at + 1
    json_skip_space()
    if (substr(json_rest, 1, 1) == ",") json_take(1)
    else { json_expect("]"); return }
  }
}

function json_string(    text, escaped) {
  json_take(1)
  text = ""
  while (match(json_rest, /^[^"\\]*/)) {
    text = text json_take(RLENGTH)
    if (substr(json_rest, 1, 1) == "\"") { json_take(1); return text }
    if (json_rest == "") break
    escaped = substr(json_rest, 2, 1)
    if (escaped == "u" && substr(json_rest, 3, 4) ~ /^[0-9a-fA-F][0-9a-fA-F][0-9a-fA-F][0-9a-fA-F]$/) {
      text = text json_utf8(json_hex(substr(json_rest, 3, 4)))
      json_take(6)
    } else if (escaped != "" && index("\"\\/bfnrt", escaped)) {
      text = text (index("\"\\/", escaped) ? escaped : " ")
      json_take(2)
    } else { json_fault("an escape that JSON does not know: " json_rest); return text }
  }
  json_fault("the line ends in a string")
  return text
}

function json_hex(digits,    at, value) {
  value = 0
  for (at = 1; at <= length(digits); ++at) value = 16 * value + index("0123456789abcdef", tolower(substr(digits, at, 1))) - 1
  return value
}

function json_utf8(code) {
  if (code < 128) return sprintf("%c", code)
  if (code < 2048) return sprintf("%c%c", 192 + int(code / 64), 128 + code % 64)
  return sprintf("%c%c%c", 224 + int(code / 4096), 128 + int(code / 64) % 64, 128 + code % 64)
}
