# Where the image cache pays: draws a chart of three panels and prints the same as a table.
# awk -f svg.awk -f pays.awk -v to=CHART.svg POINTS.csv > TABLE.md
# A line is "panel,line,x,ratio,least,greatest,cpu_ms,cpu_ms_without,pictures,made": CPU time of frames with pictures over that without,
# and how far blocks of the frames spread. Panels are speed, overdraw and size. Every line is checked; the first that is wrong is named.

function refuse(what) { print "pays.awk: " what > "/dev/stderr"; failed = 1; exit 1 }
function is_number(text) { return text ~ /^[0-9]+(\.[0-9]+)?(e[-+]?[0-9]+)?$/ }

BEGIN {
  FS = ","
  panels = split("speed overdraw size", panel_names, " ")
  title["speed"] = "Speed: forest, 1280x720"; axis["speed"] = "speed of the eye, m/s"; unit["speed"] = "m/s"
  title["overdraw"] = "Overdraw: wall of layers, 1280x720, 1.4 m/s"; axis["overdraw"] = "overdraw, fragments a pixel"; unit["overdraw"] = "fragments a pixel"
  title["size"] = "Size: forests, 1.4 m/s"; axis["size"] = "triangles of a frame without pictures, thousands"; unit["size"] = "thousand triangles"
}
/^#/ || NF == 0 { next }
{
  if (NF != 10) refuse(FILENAME ":" FNR ": has " NF " columns, not 10")
  if (!($1 in title)) refuse(FILENAME ":" FNR ": there is no panel " $1)
  for (i = 3; i <= 10; ++i) if (!is_number($i)) refuse(FILENAME ":" FNR ": " $i " is no number")
  if (!($3 > 0 && $4 > 0)) refuse(FILENAME ":" FNR ": x and ratio are above 0")
  if ($5 + 0 > $4 + 0 || $6 + 0 < $4 + 0) refuse(FILENAME ":" FNR ": the ratio is outside of its spread")
  if (!(($1, $2) in count)) line_name[$1, ++lines[$1]] = $2
  n = ++count[$1, $2]
  for (at = n; at > 1 && x[$1, $2, at - 1] > $3 + 0; --at) {  # in the order of x, whatever the order of the file
    x[$1, $2, at] = x[$1, $2, at - 1]; row[$1, $2, at] = row[$1, $2, at - 1]
  }
  x[$1, $2, at] = $3 + 0; row[$1, $2, at] = $0
  if (!($1 in low) || $3 + 0 < low[$1]) low[$1] = $3 + 0
  if (!($1 in high) || $3 + 0 > high[$1]) high[$1] = $3 + 0
  if ($6 + 0 > highest) highest = $6 + 0
}

function ratio_at(p, name, n,    of) { split(row[p, name, n], of, ","); return of[4] + 0 }

# Where a line crosses the ratio 1: on a logarithmic axis, between the two points beside it. Empty: nowhere.
function crossings(p, name,    n, a, b, t, text) {
  for (n = 2; n <= count[p, name]; ++n) {
    a = ratio_at(p, name, n - 1) - 1; b = ratio_at(p, name, n) - 1
    if (a * b >= 0) continue
    t = a / (a - b)
    text = text (text == "" ? "" : ", ") sprintf("%.2g", exp(log(x[p, name, n - 1]) * (1 - t) + log(x[p, name, n]) * t))
  }
  return text
}
function verdict(p, name,    at, n, below) {
  at = crossings(p, name)
  if (at != "") return "crosses 1 at " at
  for (n = 1; n <= count[p, name]; ++n) below += ratio_at(p, name, n) < 1
  return below == count[p, name] ? "below 1 at all points" : below == 0 ? "never below 1" : "touches 1"
}

# ---- the chart ----

function plot_x(p, v) { return left + 14 + (high[p] > low[p] ? log(v / low[p]) / log(high[p] / low[p]) : 0.5) * (inner_width - 28) }
function plot_y(r) { return top + inner_height * (1 - r / highest) }
function number(v) { return v < 10 ? sprintf("%.2g", v) : sprintf("%.0f", v) }
function centred(at, y, text) { put(sprintf("<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\">%s</text>", at, y, svg_text(text))) }

# Ticks at 1, 2 and 5 times powers of ten; where these are too few, at the points themselves.
function x_ticks(p,    decade, k, v, ticks, steps, last_x, s, n) {
  split("1 2 5", steps, " ")
  for (decade = -3; decade <= 7; ++decade)
    for (k = 1; k <= 3; ++k) {
      v = steps[k] * 10 ^ decade
      if (v >= low[p] * 0.999 && v <= high[p] * 1.001) ticks[++n] = v
    }
  if (n < 2) {
    n = 0
    for (s = 1; s <= count[p, line_name[p, 1]]; ++s) ticks[++n] = x[p, line_name[p, 1], s]
  }
  last_x = -100
  for (k = 1; k <= n; ++k) {
    put(sprintf("<path stroke=\"#888\" d=\"M%.1f %.1fv4\"/>", plot_x(p, ticks[k]), top + inner_height))
    if (plot_x(p, ticks[k]) - last_x < 24) continue
    last_x = plot_x(p, ticks[k])
    centred(last_x, top + inner_height + 17, number(ticks[k]))
  }
}

function draw_line(p, s, y,    name, colour, n, path, of, at, dash) {
  name = line_name[p, s]
  colour = colours[(s - 1) % 7 + 1]
  dash = name ~ /curve-accuracy/ ? " stroke-dasharray=\"5 3\"" : ""
  for (n = 1; n <= count[p, name]; ++n) {
    split(row[p, name, n], of, ",")
    at = plot_x(p, of[3]) + 3 * (s - (lines[p] + 1) / 2)  # beside each other, so that no bar hides another
    path = path (n == 1 ? "M" : "L") sprintf("%.1f %.1f", at, plot_y(of[4]))
    put(sprintf("<path class=\"line\" stroke=\"%s\" d=\"M%.1f %.1fV%.1fm-3 0h6M%.1f %.1fh6\"/>", colour, at, plot_y(of[5]), plot_y(of[6]), at - 3, plot_y(of[5])))
    put(sprintf("<circle cx=\"%.1f\" cy=\"%.1f\" r=\"3\" fill=\"%s\"/>", at, plot_y(of[4]), colour))
  }
  put("<path class=\"line\" stroke=\"" colour "\"" dash " d=\"" path "\"/>")
  put(sprintf("<path stroke=\"%s\" stroke-width=\"2\"%s d=\"M%.1f %.1fh22\"/>", colour, dash, left, y - 4))
  put(sprintf("<text x=\"%.1f\" y=\"%.1f\" fill=\"%s\">%s: %s</text>", left + 28, y, colour, svg_text(name), verdict(p, name)))
}

function draw_panel(i,    p, r, s) {
  p = panel_names[i]
  left = (i - 1) * page_width / 3 + 58; top = 40; inner_width = page_width / 3 - 74; inner_height = 250
  put(sprintf("<text x=\"%.1f\" y=\"20\" class=\"title\">%s</text>", left, title[p]))
  for (r = 0; r <= highest + 1e-9; r += 0.2) {
    put(sprintf("<path class=\"grid\" d=\"M%.1f %.1fh%.1f\"/>", left, plot_y(r), inner_width))
    label(left - 6, plot_y(r) + 4, "scale", sprintf("%.1f", r))
  }
  put(sprintf("<path stroke=\"#222\" stroke-width=\"1.5\" d=\"M%.1f %.1fh%.1f\"/>", left, plot_y(1), inner_width))
  put(sprintf("<text transform=\"translate(%.1f %.1f) rotate(-90)\" text-anchor=\"middle\">CPU time with pictures / without</text>", left - 38, top + inner_height / 2))
  centred(left + inner_width / 2, top + inner_height + 38, axis[p])
  if (lines[p] == 0) { label(left + 8, top + 20, "note", "not measured yet"); return }
  x_ticks(p)
  for (s = 1; s <= lines[p]; ++s) draw_line(p, s, top + inner_height + 44 + 19 * s)
}

# ---- the table: a row a line of the chart, for the page; all else stands in the points ----

function write_table(    i, p, s, n, of, text, ms) {
  print "| panel, x | line | ratio at x | CPU ms a frame at the first and the last x: without, with | |"
  print "|---|---|---|---|---|"
  for (i = 1; i <= panels; ++i) {
    p = panel_names[i]
    for (s = 1; s <= lines[p]; ++s) {
      text = ms = ""
      for (n = 1; n <= count[p, line_name[p, s]]; ++n) {
        split(row[p, line_name[p, s], n], of, ",")
        text = text (n == 1 ? "" : ", ") sprintf("%s: %.2f", number(of[3]), of[4])
        if (n == 1 || n == count[p, line_name[p, s]]) ms = ms (n == 1 ? "" : "; ") number(of[8]) ", " number(of[7])
      }
      printf "| %s, %s | %s | %s | %s | %s |\n", p, unit[p], line_name[p, s], text, ms, verdict(p, line_name[p, s])
    }
  }
}

END {
  if (failed) exit 1
  for (i = 1; i <= panels; ++i) if (lines[panel_names[i]] > lines_max) lines_max = lines[panel_names[i]]
  if (lines_max == 0) refuse("there is no point")
  page_width = 1200
  high_px = 40 + 250 + 74 + 19 * lines_max
  highest = (int(5 * (highest > 1.1 ? highest : 1.1) + 0.999) + 0) / 5
  open_svg(to, page_width, high_px)
  for (i = 1; i <= panels; ++i) draw_panel(i)
  label(58, high_px - 8, "note", "Above the line at 1 the cache costs more than it saves. A bar goes from the least to the greatest of six blocks of frames. Points of one x are drawn beside each other.")
  close_svg()
  write_table()
}
