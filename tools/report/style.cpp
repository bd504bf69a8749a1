// Style: CSS variables hold the palette, every rule names them, and a chart of its own gets them written out.
#include "tools/report/style.hpp"

#include <fmt/format.h>

namespace surefoot::report {

namespace {

constexpr std::string_view light_palette =
    "--bg:#f6f4ef;--panel:#fffefb;--ink:#1b2430;--soft:#5d6876;--rule:#e4dfd4;--accent:#0f6e84;--band:#0f6e84;"
    "--good:#24784a;--warn:#a86107;--bad:#bf3326;--goodbg:#e4f1e6;--warnbg:#fbeed7;--badbg:#fae3de;"
    "--s0:#0f6e84;--s1:#c2571a;--s2:#6b4fa1;--s3:#2f8a4c;--s4:#b02a5b;--s5:#8a6d00;--s6:#3b62b8;--s7:#6b7280;";
constexpr std::string_view dark_palette =
    "--bg:#11161d;--panel:#181f28;--ink:#e9ecf0;--soft:#98a3b1;--rule:#2b3542;--accent:#5cc4dc;--band:#5cc4dc;"
    "--good:#6fd39b;--warn:#f0ad58;--bad:#ff8170;--goodbg:#173226;--warnbg:#3a2c14;--badbg:#3e201c;"
    "--s0:#5cc4dc;--s1:#f49a5b;--s2:#b79cf0;--s3:#7bd48f;--s4:#f583ab;--s5:#dcc04a;--s6:#8fb0ff;--s7:#a4adb9;";

constexpr std::string_view chart_rules = R"css(
.chart{font:12px/1.2 system-ui,-apple-system,"Segoe UI",Roboto,"Noto Sans",sans-serif;font-variant-numeric:tabular-nums}
.chart text{fill:var(--ink)}
.chart .tick,.chart .unit,.chart .note{fill:var(--soft);font-size:11.5px}
.chart .title{font-weight:600;font-size:13.5px}
.chart .strong{font-weight:600}
.chart .mid{text-anchor:middle}.chart .end{text-anchor:end}
.chart .grid{stroke:var(--rule);stroke-width:1}
.chart .axis{stroke:var(--soft);stroke-width:1;opacity:.55}
.chart .line{fill:none;stroke:var(--accent);stroke-width:1.6;stroke-linejoin:round;stroke-linecap:round}
.chart .peaks{fill:none;stroke:var(--band);stroke-width:.8;opacity:.55}
.chart .band{fill:var(--band);opacity:.22}
.chart .bar{fill:var(--accent)}.chart .bar.late{fill:var(--bad)}.chart .bar.other{fill:var(--soft);opacity:.55}
.chart .deadline{stroke:var(--bad);stroke-width:1.4}
.chart .budget{stroke:var(--warn);stroke-width:1.4;stroke-dasharray:5 4}
.chart .deadline-text{fill:var(--bad)}.chart .budget-text{fill:var(--warn)}
.chart .miss{fill:var(--bad);stroke:var(--panel);stroke-width:1.2}
.chart .snapshot{fill:var(--panel);stroke:var(--accent);stroke-width:1.8}
.chart .snapshot-line{stroke:var(--accent);stroke-width:1;stroke-dasharray:2 3;opacity:.6}
.chart .hit{fill:var(--ink);fill-opacity:0}.chart .hit:hover{fill-opacity:.07}
.chart .dot{stroke:var(--panel);stroke-width:1.5}.chart .front{fill:none;stroke:var(--ink);stroke-width:1.2}.chart .as-swept{fill:var(--ink)}.chart .change{fill:transparent;stroke:var(--ink);stroke-width:1.2}
.chart .cone{fill:var(--accent);opacity:.13}.chart .cone-edge{stroke:var(--accent);stroke-width:1;opacity:.55}
.chart .eye{fill:var(--accent);stroke:var(--panel);stroke-width:2}
.chart .world{fill:none;stroke:var(--rule);stroke-width:1}
.chart .k0{fill:var(--s1);stroke:var(--s1)}.chart .k1{fill:var(--s0);stroke:var(--s0)}.chart .k2{fill:var(--s2);stroke:var(--s2)}
.chart .node{stroke-width:.7;stroke-opacity:.75}
.chart .stack{shape-rendering:crispEdges}
.chart .p0{fill:var(--s7)}.chart .p1{fill:var(--s2)}.chart .p2{fill:var(--s0)}.chart .p3{fill:var(--s3)}.chart .p4{fill:var(--s5)}
)css";

constexpr std::string_view page_rules = R"css(
*{box-sizing:border-box}
html{color-scheme:light dark}
body{margin:0;background:var(--bg);color:var(--ink);font:16px/1.5 system-ui,-apple-system,"Segoe UI",Roboto,"Noto Sans",sans-serif}
main{max-width:1120px;margin:0 auto;padding:40px 24px 72px}
header .brand{font-size:13px;letter-spacing:.09em;text-transform:uppercase;color:var(--soft);margin:0 0 12px}
header .brand b{color:var(--accent);font-weight:700}
h1{font-size:clamp(26px,3.6vw,40px);line-height:1.16;letter-spacing:-.018em;margin:0 0 12px;font-weight:680;text-wrap:balance}
h2{font-size:20px;letter-spacing:-.01em;margin:52px 0 4px;font-weight:650}
h3{font-size:15px;margin:0 0 2px;font-weight:630}
p{margin:0 0 12px;max-width:76ch}
.lead{font-size:17px;color:var(--soft)}
.lead b,.sub b{color:var(--ink);font-weight:600}
.sub{color:var(--soft);font-size:14.5px;margin-bottom:14px}
.badge{display:inline-flex;align-items:center;gap:8px;border-radius:99px;padding:3px 13px 3px 10px;font-size:13.5px;font-weight:600;margin-bottom:14px}
.badge i{width:9px;height:9px;border-radius:50%;background:currentColor}
.good{color:var(--good);background:var(--goodbg)}.warn{color:var(--warn);background:var(--warnbg)}.bad{color:var(--bad);background:var(--badbg)}
.tiles{display:grid;grid-template-columns:repeat(auto-fit,minmax(158px,1fr));gap:12px;margin:26px 0 14px}
.tile{background:var(--panel);border:1px solid var(--rule);border-radius:12px;padding:13px 16px 12px}
.tile .name{font-size:13px;color:var(--soft)}
.tile .value{font-size:27px;font-weight:650;letter-spacing:-.02em;line-height:1.25;font-variant-numeric:tabular-nums}
.tile .value small{font-size:14px;font-weight:500;color:var(--soft);letter-spacing:0}
.tile .note{font-size:12.5px;color:var(--soft)}
.card{background:var(--panel);border:1px solid var(--rule);border-radius:14px;padding:18px 20px 12px;margin:14px 0;min-width:0}
.card p{font-size:13.5px;color:var(--soft);margin:0 0 8px}
.two{display:grid;grid-template-columns:1fr 1fr;gap:14px}.two .card{margin:0}.two{margin:14px 0}
.wide{overflow-x:auto}
svg.chart{display:block;width:100%;height:auto;overflow:visible}
.snapshot{background:var(--panel);border:1px solid var(--rule);border-radius:14px;padding:18px 20px 20px;margin:16px 0}
.snapshot .head{display:flex;flex-wrap:wrap;gap:6px 14px;align-items:baseline;margin-bottom:12px}
.snapshot .head h3{font-size:17px;margin:0}
.chips{display:flex;flex-wrap:wrap;gap:6px}
.chip{border:1px solid var(--rule);border-radius:99px;padding:1px 10px;font-size:13px;color:var(--soft);font-variant-numeric:tabular-nums}
.chip b{color:var(--ink);font-weight:600}
.views{display:grid;grid-template-columns:1fr 1fr;gap:14px}
figure{margin:0;min-width:0}
figure.birds-eye img{max-width:420px;image-rendering:pixelated}
figure img{display:block;width:100%;height:auto;border-radius:8px;background:#000}
figure .map{border:1px solid var(--rule);border-radius:8px;overflow:hidden;background:var(--bg)}
figcaption{font-size:13px;color:var(--soft);margin-top:6px}
.notes{list-style:none;margin:14px 0;padding:0;display:grid;gap:10px}
.notes li{background:var(--warnbg);border-radius:12px;padding:12px 16px;font-size:14.5px}
.notes li b{color:var(--warn);font-weight:640}
.notes code{display:block;margin-top:4px;white-space:pre-wrap;overflow-wrap:anywhere}
code{font:13px/1.5 ui-monospace,SFMono-Regular,Menlo,Consolas,monospace}
.legend{display:flex;flex-wrap:wrap;gap:4px 16px;font-size:13px;color:var(--soft);margin:2px 0 8px}
.legend span{display:inline-flex;align-items:center;gap:6px}
.legend i{width:11px;height:11px;border-radius:3px;display:inline-block}
.c0{background:var(--s0)}.c1{background:var(--s1)}.c2{background:var(--s2)}.c3{background:var(--s3)}.c4{background:var(--s4)}.c5{background:var(--s5)}.c6{background:var(--s6)}.c7{background:var(--s7)}
.u0{background:#d02824}.u1{background:#fafafa}.u2{background:#101010}.u1,.u2{outline:1px solid var(--rule)}
.chart .u0{fill:#d02824}.chart .u1{fill:#fafafa}.chart .u2{fill:#101010}.chart .u1,.chart .u2{stroke:var(--rule);stroke-width:.4}
.c8{background:var(--soft);opacity:.55}
table{border-collapse:collapse;width:100%;font-size:14px;font-variant-numeric:tabular-nums}
th,td{text-align:right;padding:6px 10px;border-bottom:1px solid var(--rule);vertical-align:top}
th{font-weight:500;color:var(--soft);font-size:13px}
th:first-child,td:first-child{text-align:left;padding-left:0}
td.words{text-align:left;overflow-wrap:anywhere}
.scroll{overflow-x:auto}
tr:last-child td{border-bottom:0}
details summary{cursor:pointer;color:var(--soft);font-size:14px;padding:6px 0}
footer{margin-top:56px;padding-top:18px;border-top:1px solid var(--rule);color:var(--soft);font-size:13.5px}
footer a{color:var(--accent)}
@media (max-width:760px){.two,.views{grid-template-columns:1fr}main{padding:26px 14px 56px}.wide svg.chart{min-width:680px}.card,.snapshot{padding:14px 14px 12px}}
@media print{body{background:#fff}.card,.snapshot,.tile{break-inside:avoid}}
)css";

}  // namespace

std::string page_style() {
    return fmt::format(":root{{{}}}\n@media (prefers-color-scheme:dark){{:root{{{}}}}}\n{}{}", light_palette, dark_palette,
                       chart_rules, page_rules);
}

std::string chart_style(bool dark) {
    return fmt::format("<style>.chart{{{}}}{}</style>", dark ? dark_palette : light_palette, chart_rules);
}

std::string page(std::string_view title, std::string_view body) {
    return fmt::format(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
        "content=\"width=device-width,initial-scale=1\">\n<meta name=\"color-scheme\" content=\"light "
        "dark\">\n<title>{}</title>\n"
        "<style>\n{}</style>\n</head>\n<body>\n<main>\n{}</main>\n</body>\n</html>\n",
        title, page_style(), body);
}

std::string stand_alone(const std::string& inline_chart, bool dark) {
    const auto tag_end = inline_chart.find('>');
    if (tag_end == std::string::npos) return inline_chart;
    return "<svg xmlns=\"http://www.w3.org/2000/svg\"" + inline_chart.substr(4, tag_end - 3) + chart_style(dark) +
           "<rect width=\"100%\" height=\"100%\" rx=\"10\" fill=\"var(--panel)\"/>" + inline_chart.substr(tag_end + 1);
}

}  // namespace surefoot::report
