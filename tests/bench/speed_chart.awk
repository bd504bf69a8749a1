# Draws an SVG of lines "scene,speed_m_s,ratio": CPU time of frames with pictures over that without, against the speed of the eye.
# awk -f speed_chart.awk SPEEDS.csv > CHART.svg

BEGIN { FS = ","; width = 640; height = 360; left = 56; right = 150; top = 40; bottom = 48; split("#1f6fb4 #c2410c #3f7d20 #7a3b9c", colours, " ") }
!/^#/ && NF == 3 && $2 > 0 {
  if (!($1 in number)) { number[$1] = ++scenes; name[scenes] = $1 }
  of = number[$1]; n = ++count[of]
  speed[of, n] = $2; ratio[of, n] = $3
  if (low == 0 || $2 < low) low = $2
  if ($2 > high) high = $2
  if ($3 > highest) highest = $3
}
function x_of(s) { return left + (high > low ? log(s / low) / log(high / low) : 0.5) * (width - left - right) }
function y_of(r) { return top + (1 - r / highest) * (height - top - bottom) }
END {
  if (scenes == 0) { print "speed_chart.awk: no line scene,speed,ratio" > "/dev/stderr"; exit 1 }
  highest = int(10 * (highest > 1 ? highest : 1) + 1.999) / 10
  printf "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" font-family=\"sans-serif\" font-size=\"12\">\n", width, height
  printf "<rect width=\"%d\" height=\"%d\" fill=\"#fff\"/>\n", width, height
  printf "<text x=\"%d\" y=\"22\" font-size=\"14\">CPU time of a frame with pictures, over that without</text>\n", left
  for (r = 0; r <= highest + 1e-9; r += 0.2) {
    printf "<path d=\"M%d %.1fH%d\" stroke=\"%s\"/>\n", left, y_of(r), width - right, (r > 0.99 && r < 1.01 ? "#555" : "#ddd")
    printf "<text x=\"%d\" y=\"%.1f\" text-anchor=\"end\">%.1f</text>\n", left - 6, y_of(r) + 4, r
  }
  for (i = 1; i <= scenes; ++i) {
    path = ""
    for (n = 1; n <= count[i]; ++n) {
      x = x_of(speed[i, n]); y = y_of(ratio[i, n])
      path = path sprintf("%s%.1f %.1f", n == 1 ? "M" : "L", x, y)
      printf "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"3.5\" fill=\"%s\"/>\n", x, y, colours[(i - 1) % 4 + 1]
      if (!(speed[i, n] in marked)) {
        marked[speed[i, n]] = 1
        printf "<text x=\"%.1f\" y=\"%d\" text-anchor=\"middle\">%g</text>\n", x, height - bottom + 18, speed[i, n]
      }
    }
    printf "<path d=\"%s\" fill=\"none\" stroke=\"%s\" stroke-width=\"2\"/>\n", path, colours[(i - 1) % 4 + 1]
    printf "<text x=\"%d\" y=\"%.1f\" fill=\"%s\">%s</text>\n", width - right + 8, y + 4, colours[(i - 1) % 4 + 1], name[i]
  }
  printf "<text x=\"%.1f\" y=\"%d\" text-anchor=\"middle\">speed, m/s</text>\n</svg>\n", (left + width - right) / 2, height - 8
}
