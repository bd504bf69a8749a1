// Bench: what share of the greatest value each selector shows, on frames along a path, at half and a quarter of the predicted
// time of full detail. bench_optimum MODEL.walk [FRAMES 20] [PATH.csv] [STATE_DIR] [LIFT_M] [STEPS 50000000] [PARTS 2000] -> one
// JSON object.
#include <fmt/format.h>

#include <chrono>
#include <cstdlib>

#include "tools/accuracy/value_share.hpp"

namespace {

using namespace surefoot;

double seconds_now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

std::string shares_json(const accuracy::ValueShares& shares, double seconds) {
    std::string out = fmt::format(
        "{{\"frames\": {}, \"proven\": {}, \"floor_frames\": {}, \"full_frames\": {}, \"bound_gap\": {:.6f}, \"seconds\": {:.2f}",
        shares.frames, shares.proven, shares.floor_frames, shares.full_frames, shares.bound_gap, seconds);
    for (const accuracy::ValueShare& s : shares.selectors)
        out += fmt::format(
            ", \"{}\": {{\"of_best\": {:.5f}, \"min_of_best\": {:.5f}, \"of_bound\": {:.5f}, \"min_of_bound\": {:.5f}}}",
            s.selector, s.of_best, s.min_of_best, s.of_bound, s.min_of_bound);
    return out + "}";
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) {
        fmt::print(stderr, "bench_optimum MODEL.walk [FRAMES] [PATH.csv] [STATE_DIR] [LIFT_M] [STEPS] [PARTS]\n");
        return 2;
    }
    walk::WalkRequest walk;
    walk.model_file = argv[1];
    if (argc > 3) walk.path_file = argv[3];
    if (argc > 4) walk.state_dir = argv[4];
    if (argc > 5) walk.lift_m = std::atof(argv[5]);
    accuracy::ShareRequest request;
    request.selectors = {"threshold", "two-stage", "best-first", "depth-first"};
    request.frames = argc > 2 ? static_cast<std::uint32_t>(std::max(1, std::atoi(argv[2]))) : 20;
    request.limits.max_steps = argc > 6 ? static_cast<std::uint64_t>(std::atoll(argv[6])) : 50'000'000;
    request.limits.max_parts = argc > 7 ? static_cast<std::uint32_t>(std::atoi(argv[7])) : 2000;
    fmt::print("{{\"model\": \"{}\"", walk.model_file);
    for (const auto& [name, share] : {std::pair{"half", 0.5}, std::pair{"quarter", 0.25}}) {
        request.share_of_full = share;
        const double begun = seconds_now();
        const auto shares = accuracy::value_shares_of_walk(walk, request, {});
        if (!shares) {
            fmt::print(stderr, "{}\n", shares.error().text());
            return 1;
        }
        fmt::print(", \"{}\": {}", name, shares_json(*shares, seconds_now() - begun));
    }
    fmt::print("}}\n");
    return 0;
}
