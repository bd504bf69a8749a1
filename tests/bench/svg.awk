# An SVG picture, piece by piece: what the charts of benches share. open_svg(file, wide, high), then put() and label(), then close_svg().

function svg_text(text) { gsub(/&/, "\\&amp;", text); gsub(/</, "\\&lt;", text); return text }
function put(text) { print text > svg_file }
function label(x, y, class, text) { put(sprintf("<text x=\"%.1f\" y=\"%.1f\" class=\"%s\">%s</text>", x, y, class, svg_text(text))) }
# Seven colours of lines that are told apart: colours[1..7].
function open_svg(file, wide, high) {
  svg_file = file
  split("#1f6fb4 #c4511a #2d8a4e #8a4fb0 #a07a00 #00848c #b03060", colours, " ")
  put(sprintf("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\" width=\"%d\" height=\"%d\" font-family=\"sans-serif\" font-size=\"12\">", wide, high, wide, high))
  put("<style>.title{font-weight:bold}.scale,.last{text-anchor:end}.scale,.date,.last{fill:#555}.note{font-size:11px;fill:#555}" \
    ".grid{stroke:#ddd;fill:none}.bound{stroke:#c00;stroke-dasharray:5 4;fill:none}.line{fill:none;stroke-width:1.5}</style>")
  put(sprintf("<rect width=\"%d\" height=\"%d\" fill=\"#fff\"/>", wide, high))
}
function close_svg() { put("</svg>"); close(svg_file) }
