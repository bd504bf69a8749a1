// Bench: the guaranteed accuracy of a walk. Every row of the ledger that kept it reached it and names the node that binds;
// captured cuts of the same walk reached what their rows say, and those that broke it had no legal cut that fits. All of it is
// computed here, from the files. bench_guarantee ACCURACY LEDGER CAPTURE... -> one JSON object; exit status 1 where something is
// untrue.
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>

#include "render/capture/capture.hpp"
#include "render/model/walk_file.hpp"
#include "tests/bench/bench_scene.hpp"
#include "tests/bench/ledger_rows.hpp"
#include "tests/cut_bounds.hpp"

namespace {

using namespace surefoot;

using bench::LedgerRow;
using bench::LedgerRows;

struct Figures {
    std::size_t kept = 0, over_budget = 0, other = 0, untrue = 0, captures = 0;
    double min_reached = std::numeric_limits<double>::infinity();
    void refute(const std::string& what) {
        ++untrue;
        fmt::print(stderr, "{}\n", what);
    }
};

void judge_rows(const LedgerRows& rows, double accuracy, Figures& figures) {
    constexpr double printed = 1e-3;  // the ledger's last digit
    for (const auto& [frame, row] : rows) {
        figures.min_reached = std::min(figures.min_reached, row.reached);
        const bool kept = row.guarantee == "kept";
        ++(kept ? figures.kept : row.guarantee == "over_budget" ? figures.over_budget : figures.other);
        if (!kept && row.guarantee != "over_budget") figures.refute(fmt::format("frame {}: {}", frame, row.guarantee));
        if (std::abs(row.guaranteed - accuracy) > printed)
            figures.refute(fmt::format("frame {} promises {}", frame, row.guaranteed));
        if (kept && row.reached < accuracy - printed) figures.refute(fmt::format("frame {} reached {}", frame, row.reached));
        if (!kept && row.reached >= accuracy)
            figures.refute(fmt::format("frame {} is marked, and reached {}", frame, row.reached));
        if (std::isfinite(row.reached) == row.node.empty())
            figures.refute(fmt::format("frame {} names node '{}'", frame, row.node));
    }
}

Result<void> judge_capture(const char* file, const model::Model& model, const LedgerRows& rows, double accuracy,
                           Figures& figures) {
    const auto of = capture::read_capture(file);
    if (!of) return of.error();
    const auto found = rows.find(of->frame);
    if (found == rows.end()) return Error{file, "The ledger has no such frame", "Capture a frame of the same walk"};
    const LedgerRow& row = found->second;
    ++figures.captures;
    if (row.cut != fmt::format("{:016x}", of->hash)) figures.refute(fmt::format("{}: the ledger has another cut", file));
    Pose pose = row.pose;
    pose.fov_y_rad = of->prepared.region.centre.fov_y_rad;
    const double reached = 1 / test::worst_seen_error(*of, model, pose);
    if (std::abs(row.reached - reached) > 1e-4 * reached)
        figures.refute(fmt::format("{}: the record says {}, the cut reached {}", file, row.reached, reached));
    const auto node = static_cast<std::uint32_t>(std::strtoul(row.node.c_str(), nullptr, 10));
    if (!row.node.empty() && !test::errs_most(*of, node, 1 / reached))
        figures.refute(fmt::format("{}: node {} does not err most", file, row.node));
    if (row.guarantee != "over_budget") return {};
    // By `near` of what fits, since costs are compared node by node, and a frame takes the larger of two sums.
    constexpr double near = 0.98;
    const double needed = test::bound_us(*of, 1 / accuracy);
    const double room = test::room_us(*of, of->items, static_cast<double>(of->predicted_us));
    fmt::print(stderr, "{}: needs at least {:.0f} us of items, has {:.0f}; reached {:.1f}\n", file, needed, room, reached);
    if (needed < near * room) figures.refute(fmt::format("{}: a legal cut of it would have fitted", file));
    return {};
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 4)
        return bench::fail(
            {"ACCURACY MODEL LEDGER CAPTURE...", "is missing", "give files of one `surefoot walk --min-accuracy`"});
    const double accuracy = std::strtod(argv[1], nullptr);
    const auto model = model::read_walk(argv[2], nullptr);
    if (!model) return bench::fail(model.error());
    const auto rows = bench::read_ledger_rows(argv[3]);
    if (!rows) return bench::fail(rows.error());
    Figures figures;
    judge_rows(*rows, accuracy, figures);
    for (int i = 4; i < argc; ++i)
        if (const Result<void> done = judge_capture(argv[i], *model, *rows, accuracy, figures); !done)
            return bench::fail(done.error());
    const std::string least = std::isfinite(figures.min_reached) ? fmt::format("{:.2f}", figures.min_reached) : "null";
    fmt::print(
        "{{\"frames\": {}, \"kept\": {}, \"over_budget\": {}, \"other\": {}, \"min_reached\": {}, \"captures\": {}, "
        "\"untrue\": {}}}\n",
        rows->size(), figures.kept, figures.over_budget, figures.other, least, figures.captures, figures.untrue);
    return figures.untrue > 0 ? 1 : 0;
}
