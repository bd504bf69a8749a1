# Prints the values of one JSON text, a line each: PATH, a tab, VALUE. awk -f json.awk -f flatten.awk. Exit status 1 if it is no JSON.
{ text = text $0 "\n" }
END {
  wrong = read_json(text, values, kinds)
  if (wrong != "") { print "no JSON: " wrong > "/dev/stderr"; exit 1 }
  for (path in values) if (kinds[path] != "object") printf "%s\t%s\n", path, values[path]
}
