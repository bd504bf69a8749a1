// Bench: is every point of the true surface drawn within the accuracy that was asked? Points in view, sampled on full detail,
// against what captured cuts of `walk --selector curve-accuracy --accuracy ACCURACY` draw there. Each capture stands with the
// ledger of its walk, which knows the pose. bench_surface_points ACCURACY POINTS MODEL LEDGER CAPTURE... -> one JSON object; exit
// status 1 where a point is farther off.
#include <fmt/format.h>

#include <cstdlib>
#include <string>

#include "render/capture/capture.hpp"
#include "render/model/walk_file.hpp"
#include "tests/bench/bench_scene.hpp"
#include "tests/bench/ledger_rows.hpp"
#include "tests/surface_points.hpp"

namespace {

using namespace surefoot;

Result<void> judge(const char* file, const model::Model& model, const bench::LedgerRows& rows, double error_rad,
                   std::size_t points, test::SurfacePoints& all) {
    const auto of = capture::read_capture(file);
    if (!of) return of.error();
    const auto found = rows.find(of->frame);
    if (found == rows.end()) return Error{file, "The ledger has no such frame", "Capture a frame of the same walk"};
    if (found->second.cut != fmt::format("{:016x}", of->hash))
        return Error{file, "The ledger has another cut", "Capture a frame of the same walk"};
    Pose pose = found->second.pose;
    pose.fov_y_rad = of->prepared.region.centre.fov_y_rad;
    const test::SurfacePoints here = test::judge_surface_points(*of, model, pose, error_rad, points);
    fmt::print(stderr, "{}: {} points on {} coarse forms, {} beyond; the worst 1/{:.1f} rad, of {}\n", file, here.points,
               here.items, here.beyond, 1 / here.worst_rad, model.name_of(model.nodes[here.worst_node]));
    all.add(here);
    return {};
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 6)
        return bench::fail({"ACCURACY POINTS MODEL LEDGER CAPTURE...", "is missing",
                            "give files of one `surefoot walk --selector curve-accuracy --accuracy ACCURACY`"});
    const double accuracy = std::strtod(argv[1], nullptr), error_rad = 1 / accuracy;
    if (!(accuracy > 0)) return bench::fail({argv[1], "is no accuracy", "give one above 0, in rad^-1"});
    const auto points = static_cast<std::size_t>(std::strtoull(argv[2], nullptr, 10));
    const auto model = model::read_walk(argv[3], nullptr);
    if (!model) return bench::fail(model.error());
    const auto rows = bench::read_ledger_rows(argv[4]);
    if (!rows) return bench::fail(rows.error());
    test::SurfacePoints all;
    const auto captures = static_cast<std::size_t>(argc - 5);
    for (int i = 5; i < argc; ++i)
        if (const Result<void> done = judge(argv[i], *model, *rows, error_rad, (points + captures - 1) / captures, all); !done)
            return bench::fail(done.error());
    fmt::print("{{\"points\": {}, \"forms\": {}, \"beyond\": {}, \"worst_accuracy\": {}}}\n", all.points, all.items, all.beyond,
               all.worst_rad > 0 ? fmt::format("{:.2f}", 1 / all.worst_rad) : "null");
    return all.beyond > 0 ? 1 : 0;
}
