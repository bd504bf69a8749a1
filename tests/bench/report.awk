# Reads results.jsonl and writes RESULTS.md, history.csv and trend.svg into a folder:
#   awk -f json.awk -f promises.awk -f report.awk -f svg.awk -f trend.awk -v promises_file=FILE -v named=NAME -v to=FOLDER results.jsonl
# Every line is checked; the first that is wrong is named with NAME:LINE and nothing is written. Exit status 1.

function refuse(what) { print what > "/dev/stderr"; failed = 1; exit 1 }
function refuse_line(what) { refuse(named ":" FNR ": " what) }

# Characters as a reader counts them: the second and later bytes of one do not count.
function width(text) { gsub(/[\200-\277]/, "", text); return length(text) }

BEGIN {
  max_lines = 180; max_width = 160
  wrong = read_promises(promises_file)
  if (wrong != "") refuse(wrong)
  split("time commit host.cpu host.kernel host.mesa promise scene unit target bound command", texts, " ")
  split("spread note why next", optional_texts, " ")
  for (t in texts) { must_have[texts[t]] = 1; known[texts[t]] = 1 }
  for (t in optional_texts) known[optional_texts[t]] = 1
  known["host"] = known["host.cores"] = known["figure"] = known["holds"] = known[""] = 1
}

{
  wrong = read_json($0, v, kinds)
  if (wrong != "") refuse_line("this is no JSON: " wrong)
  if (kinds[""] != "object") refuse_line("a line is one object")
  for (name in kinds) if (!(name in known)) refuse_line("there is no field " name)
  for (name in must_have) if (kinds[name] != "string") refuse_line("the text " name " is missing")
  for (t in optional_texts) if ((optional_texts[t] in kinds) && kinds[optional_texts[t]] != "string") refuse_line(optional_texts[t] " is no text")
  if (kinds["figure"] != "number") refuse_line("the number figure is missing")
  if (kinds["host.cores"] != "number") refuse_line("the number host.cores is missing")
  if (v["time"] !~ /^20[0-9][0-9]-[01][0-9]-[0-3][0-9]T[0-2][0-9]:[0-5][0-9]:[0-5][0-9]Z$/) refuse_line("the time " v["time"] " is not as 2026-11-24T21:00:08Z")
  if (v["commit"] !~ /^([0-9a-f]+[+]?|unknown)$/) refuse_line("the commit " v["commit"] " is none")
  if (!is_bound(v["bound"])) refuse_line("the bound " v["bound"] " is none")
  if (!(v["promise"] in group_of)) refuse_line("there is no promise " v["promise"] " in " promises_file)
  if (v["holds"] != holds_in(v["figure"], v["bound"])) refuse_line("holds is " v["holds"] ", but the figure " v["figure"] " and the bound " v["bound"] " say " holds_in(v["figure"], v["bound"]))
  keep_figure()
}

function keep_figure(    key, k) {
  n = ++figures
  time_of[n] = v["time"]; commit_of[n] = v["commit"]; promise_of[n] = v["promise"]; scene_of[n] = v["scene"]; figure_of[n] = v["figure"]
  judged_of[n] = holds_in(v["figure"], bound_of[v["promise"]])  # by the target of today; the line says what it was
  host_of[n] = v["host.cpu"] ", " v["host.cores"] " cores" (v["host.kernel"] == "" ? "" : ", Linux " v["host.kernel"]) (v["host.mesa"] == "" ? "" : ", Mesa " v["host.mesa"])
  row_of[n] = column("time") "," column("commit") "," column("host.cpu") "," column("host.cores") "," column("host.kernel") "," column("host.mesa") "," \
    column("promise") "," column("scene") "," column("figure") "," column("unit") "," column("target") "," column("bound") "," column("holds") "," \
    column("spread") "," column("command") "," column("note") "," column("why") "," column("next")
  key = v["promise"] SUBSEP v["scene"]
  if (!(key in newest) || time_of[newest[key]] <= v["time"]) newest[key] = n
  # A figure that is recorded without a reason keeps the last one that was given.
  if (("why" in v) && v["why"] != "" && (!(key in reason_at) || reason_at[key] <= v["time"])) {
    reason_at[key] = v["time"]; why_of[key] = v["why"]; next_of[key] = ("next" in v) ? v["next"] : ""
  }
}

# A cell of the CSV; empty where the line has no such field.
function column(name,    text) {
  text = (name in v) ? v[name] "" : ""
  if (text !~ /[",]/) return text
  gsub(/"/, "\"\"", text)
  return "\"" text "\""
}

# ---- RESULTS.md ----

function line(text) {
  if (width(text) > max_width) refuse("RESULTS.md would have a line of " width(text) " characters: " text)
  page[++lines] = text
}

# Breaks text at spaces; what follows the first line is indented.
function paragraph(text, indent,    words, count, w, now) {
  count = split(text, words, " ")
  now = words[1]
  for (w = 2; w <= count; ++w) {
    if (width(now " " words[w]) > max_width) { line(now); now = indent words[w] } else now = now " " words[w]
  }
  line(now)
}

function cell(text) { gsub(/\|/, "\\|", text); return text }

# The scenes of a promise in the order of their names; the promise without a scene comes first.
function scenes_of(promise, list,    key, parts, count, i, j, swap) {
  count = 0
  for (key in newest) { split(key, parts, SUBSEP); if (parts[1] == promise) list[++count] = parts[2] }
  for (i = 2; i <= count; ++i)
    for (j = i; j > 1 && list[j - 1] > list[j]; --j) { swap = list[j]; list[j] = list[j - 1]; list[j - 1] = swap }
  return count
}

function host_letter(host) {
  if (!(host in letter)) { letter[host] = sprintf("%c%s", 65 + hosts % 26, hosts < 26 ? "" : int(hosts / 26)); host_named[++hosts] = host }
  return letter[host]
}

# One figure in a row: the scene, the figure, in bold where it misses its target.
function shown(n,    text) {
  text = (scene_of[n] == "" ? "" : scene_of[n] ": ") figure_of[n]
  return cell(judged_of[n] == "false" ? "**" text "**" : text)
}

# Where the whole group has one command, its heading names it.
function row(promise, first, list, held, all, n, commits,    command) {
  command = one_command != "" ? "" : first ? " `" cell(command_of[promise]) "` |" : " |"
  return (first ? "| " promise " | " cell(target_of[promise]) : "| |") " | " list " | " (held == all ? "yes" : held == 0 ? "**no**" : held " of " all) \
    " | " commits " | " host_letter(host_of[n]) " | " substr(time_of[n], 1, 10) " |" command
}

# Rows of one promise: scenes of the same host and day share one, as long as it fits. Their commits stand in the order of the scenes.
function promise_rows(promise,    scenes, count, i, j, n, m, used, list, more, commits, more_commits, held, all, first) {
  count = scenes_of(promise, scenes)
  first = 1
  for (i = 1; i <= count; ++i) {
    n = newest[promise, scenes[i]]
    if (n in used) continue
    list = commits = ""; held = all = 0
    for (j = i; j <= count; ++j) {
      m = newest[promise, scenes[j]]
      if ((m in used) || host_of[m] != host_of[n] || substr(time_of[m], 1, 10) != substr(time_of[n], 1, 10)) continue
      more = list (list == "" ? "" : ", ") shown(m)
      more_commits = index(commits, commit_of[m]) ? commits : commits (commits == "" ? "" : ", ") commit_of[m]
      if (list != "" && width(row(promise, first, more, 10, 11, n, more_commits)) > max_width) {
        line(row(promise, first, list, held, all, n, commits))
        first = held = all = 0
        more = shown(m); more_commits = commit_of[m]
      }
      list = more; commits = more_commits; used[m] = 1; ++all
      if (judged_of[m] == "true") ++held
    }
    line(row(promise, first, list, held, all, n, commits))
    first = 0
  }
}

# Promises that hold may stand in history.csv alone: the page has few lines. A miss is listed all the same.
function on_page(promise) { return bound_of[promise] != "-" && group_of[promise] != "History only" }

# Figures that miss their target, those with the same reason together.
function missed_list(    p, scenes, count, i, n, key, reason, reasons, order_of_reasons, of_promise, text, r) {
  for (p = 1; p <= promises; ++p) {
    split("", scenes); split("", of_promise)
    count = bound_of[order[p]] == "-" ? 0 : scenes_of(order[p], scenes)
    for (i = 1; i <= count; ++i) {
      key = order[p] SUBSEP scenes[i]; n = newest[key]
      if (judged_of[n] != "false") continue
      reason = !(key in why_of) ? "No reason is recorded yet." : "Why: " why_of[key] (next_of[key] == "" ? "" : " Next: " next_of[key])
      if (!(reason in reasons)) order_of_reasons[++r] = reason
      text = (reason in of_promise) ? ", " : (reasons[reason] == "" ? "" : "; ") order[p] " (" target_of[order[p]] ") "
      of_promise[reason] = 1
      reasons[reason] = reasons[reason] text (scenes[i] == "" ? "" : scenes[i] ": ") figure_of[n]
    }
  }
  if (r == 0) return
  line(""); line("## Missed targets")
  for (i = 1; i <= r; ++i) paragraph("* " reasons[order_of_reasons[i]] ". " order_of_reasons[i], "  ")
}

# A figure without a scene gives way to newer ones of scenes: since then the promise is measured scene by scene.
function give_way(    key, parts, whole, gone) {
  for (key in newest) {
    split(key, parts, SUBSEP)
    whole = parts[1] SUBSEP ""
    if (parts[2] != "" && (whole in newest) && time_of[newest[key]] > time_of[newest[whole]]) gone[whole] = 1
  }
  for (whole in gone) delete newest[whole]
}

# The command that all promises of a group share; empty where there are several.
function command_of_group(group,    p, command) {
  for (p = 1; p <= promises; ++p) {
    if (group_of[order[p]] != group) continue
    if (command != "" && command != command_of[order[p]]) return ""
    command = command_of[order[p]]
  }
  return command
}

function write_page(    p, g, groups, group_list, has_figures, count, with, whole, held, all, scenes, i, ok, without, text) {
  give_way()
  for (p = 1; p <= promises; ++p) {
    if (bound_of[order[p]] != "-" && !on_page(order[p])) ++elsewhere
    if (!on_page(order[p])) continue
    if (!(group_of[order[p]] in groups)) { groups[group_of[order[p]]] = 1; group_list[++g] = group_of[order[p]] }
    split("", scenes)
    count = scenes_of(order[p], scenes); ok = 0
    for (i = 1; i <= count; ++i) ok += judged_of[newest[order[p], scenes[i]]] == "true"
    if (count == 0) { without = without (without == "" ? "" : ", ") order[p]; continue }
    ++with; all += count; held += ok; has_figures[group_of[order[p]]] = 1
    if (ok == count) ++whole
  }
  line("# Results")
  line("")
  line("Written by `tests/bench/report` from [results.jsonl](results.jsonl). Do not edit it by hand. Every figure: [history.csv](history.csv).")
  line("What a promise means: [promises.tsv](promises.tsv). Hard rows without their safeguard: [mutations.csv](mutations.csv). Walks are 1280×720 at 30 Hz.")
  line("A GPU walks at 60 Hz; its 21 M are triangles of a forest. Bold figures miss. Where a host names no kernel, the commit brought the figure here.")
  line("")
  line("**" whole + 0 " of " with + 0 " promises hold** in every scene; " held + 0 " of " all + 0 " newest figures hold." (elsewhere ? " Figures of " elsewhere " more promises stand in history.csv alone." : ""))
  if (without != "") paragraph("No figure yet: " without ".", "")
  line("")
  line("![Promises that hold, and key figures over time](trend.svg)")
  for (i = 1; i <= g; ++i) {
    if (!(group_list[i] in has_figures)) continue
    one_command = command_of_group(group_list[i])
    line(""); line("## " group_list[i] (one_command == "" ? "" : ": `" one_command "`"))
    line("| promise | target | newest figures | holds | commit | host | date |" (one_command == "" ? " command |" : ""))
    line("|---|---|---|---|---|---|---|" (one_command == "" ? "---|" : ""))
    for (p = 1; p <= promises; ++p) if (group_of[order[p]] == group_list[i]) promise_rows(order[p])
  }
  missed_list()
  text = ""
  for (i = 1; i <= hosts; ++i) text = text (i == 1 ? "Hosts: " : "; ") letter[host_named[i]] " is " host_named[i]
  if (hosts > 0) { line(""); paragraph(text ".", "") }
  if (lines > max_lines) refuse("RESULTS.md would have " lines " lines, " max_lines " at most: put promises together in " promises_file)
}

function write_file(name, count, texts,    i) {
  for (i = 1; i <= count; ++i) print texts[i] > (to "/" name)
  close(to "/" name)
}

END {
  if (failed) exit 1
  write_page()
  if (failed) exit 1
  write_file("RESULTS.md", lines, page)
  history[1] = "time,commit,cpu,cores,kernel,mesa,promise,scene,figure,unit,target,bound,holds,spread,command,note,why,next"
  for (n = 1; n <= figures; ++n) history[n + 1] = row_of[n]
  write_file("history.csv", figures + 1, history)
  write_trend(to "/trend.svg")
}
