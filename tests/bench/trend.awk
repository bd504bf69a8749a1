# Draws trend.svg: the share of promises that hold, and the figures of the promises marked in the column trend, over time. For report.awk, after svg.awk.

# Days since 1970 of a time such as 2026-11-24T21:00:08Z.
function days_of(time,    y, m, d) {
  y = substr(time, 1, 4) + 0; m = substr(time, 6, 2) + 0; d = substr(time, 9, 2) + 0
  if (m <= 2) { --y; m += 12 }
  return 365 * y + int(y / 4) - int(y / 100) + int(y / 400) + int((153 * m - 457) / 5) + d - 719469 + \
    (substr(time, 12, 2) + substr(time, 15, 2) / 60 + substr(time, 18, 2) / 3600) / 24
}

function x_of(time) { return left + (last_day > first_day ? (days_of(time) - first_day) / (last_day - first_day) : 0.5) * inner_width }
function y_of(figure) { return top + inner_height * (1 - figure / highest) }

# A frame of a panel at x, y; sets left, top, inner_width, inner_height and highest for what is drawn into it.
function panel(x, y, wide, high, title, max_value,    step, value) {
  left = x + 44; top = y + 46; inner_width = wide - 60; inner_height = high - 70
  step = 1
  while (max_value / step > 5) step *= (substr(sprintf("%e", step), 1, 1) == "2") ? 2.5 : 2
  while (max_value / step < 2) step /= 2
  highest = step * (int(max_value / step) + 1)
  label(x + 8, y + 16, "title", title)
  for (value = 0; value <= highest * 1.0001; value += step) {
    put(sprintf("<path class=\"grid\" d=\"M%.1f %.1fh%.1f\"/>", left, y_of(value), inner_width))
    label(left - 6, y_of(value) + 4, "scale", value "")
  }
  label(left, top + inner_height + 18, "date", substr(first_time, 1, 10))
  if (substr(last_time, 1, 10) != substr(first_time, 1, 10)) label(left + inner_width, top + inner_height + 18, "last", substr(last_time, 1, 10))
}

# Indices of the figures by time; of the same time in the order of the file.
function sort_by_time(sorted,    i, j, held) {
  for (i = 1; i <= figures; ++i) {
    held = i
    for (j = i; j > 1 && time_of[sorted[j - 1]] > time_of[held]; --j) sorted[j] = sorted[j - 1]
    sorted[j] = held
  }
}

# Share of newest figures within their bounds, after each time of recording.
function share_panel(sorted,    i, n, key, latest, held, all, path, y) {
  panel(0, 0, page_width, 190, "Newest figures that hold their promise, %", 99)
  for (i = 1; i <= figures; ++i) {
    n = sorted[i]; key = promise_of[n] SUBSEP scene_of[n]
    if (judged_of[n] == "null") continue
    if (key in latest) held -= latest[key] == "true"; else ++all
    latest[key] = judged_of[n]; held += judged_of[n] == "true"
    if (i < figures && time_of[sorted[i + 1]] == time_of[n]) continue
    y = y_of(100 * held / all)
    path = path (path == "" ? sprintf("M%.1f %.1f", x_of(time_of[n]), y) : sprintf("H%.1fV%.1f", x_of(time_of[n]), y))
  }
  if (path != "") {
    put("<path class=\"line\" stroke=\"" colours[1] "\" d=\"" path "\"/>")
    label(page_width - 12, 16, "last", sprintf("%d of %d, %.0f %%", held, all, 100 * held / all))
  } else label(left + 8, top + 20, "note", "no figure yet")
}

function promise_panel(promise, x, y, sorted,    i, n, max_value, limit, scenes, count, of, path, s, names, wide) {
  wide = page_width / 3
  limit = bound_of[promise]; gsub(/[<>=]/, "", limit)
  max_value = limit + 0
  for (i = 1; i <= figures; ++i) if (promise_of[i] == promise && figure_of[i] + 0 > max_value) max_value = figure_of[i] + 0
  panel(x, y, wide, 200, promise ", target " target_of[promise], max_value)
  put(sprintf("<path class=\"bound\" d=\"M%.1f %.1fh%.1f\"/>", left, y_of(limit), inner_width))
  count = scenes_of(promise, scenes)
  for (s = 1; s <= count; ++s) {
    path = ""
    for (i = 1; i <= figures; ++i) {
      n = sorted[i]
      if (promise_of[n] != promise || scene_of[n] != scenes[s]) continue
      path = path (path == "" ? "M" : "L") sprintf("%.1f %.1f", x_of(time_of[n]), y_of(figure_of[n]))
      put(sprintf("<circle cx=\"%.1f\" cy=\"%.1f\" r=\"2.5\" fill=\"%s\"/>", x_of(time_of[n]), y_of(figure_of[n]), colours[(s - 1) % 7 + 1]))
    }
    put("<path class=\"line\" stroke=\"" colours[(s - 1) % 7 + 1] "\" d=\"" path "\"/>")
    names = names "<tspan fill=\"" colours[(s - 1) % 7 + 1] "\">" svg_text(scenes[s]) "</tspan> "
  }
  put(sprintf("<text x=\"%.1f\" y=\"%.1f\" class=\"note\">%s</text>", x + 8, y + 32, count == 0 ? "no figure yet" : names))
}

function write_trend(file,    p, shown_panels, count, sorted, i, high) {
  page_width = 1080
  for (p = 1; p <= promises; ++p) if (trend_of[order[p]] == "yes") shown_panels[++count] = order[p]
  sort_by_time(sorted)
  if (figures > 0) { first_time = time_of[sorted[1]]; last_time = time_of[sorted[figures]] }
  first_day = figures > 0 ? days_of(first_time) : 0; last_day = figures > 0 ? days_of(last_time) : 0
  high = 200 + 210 * int((count + 2) / 3)
  open_svg(file, page_width, high)
  share_panel(sorted)
  for (i = 1; i <= count; ++i) promise_panel(shown_panels[i], (i - 1) % 3 * page_width / 3, 200 + 210 * int((i - 1) / 3), sorted)
  close_svg()
}
