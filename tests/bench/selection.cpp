// Bench: selecting among 10^5 candidates, and preparing on a model of 10^6 nodes. bench_selection -> one JSON object.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <numbers>
#include <vector>

#include "rt/base/statistics.hpp"
#include "tests/select/scene.hpp"

namespace {

using namespace surefoot;

template <class Work>
double milliseconds(Work work) {
    const auto begun = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begun).count();
}

/// ms of one selection, median of 31, with the memory of the selection before.
double select_ms(test::Scene& scene, const char* selector, double budget_us) {
    std::vector<double> ms;
    for (int i = 0; i < 31; ++i) ms.push_back(milliseconds([&] { scene.run(selector, budget_us); }));
    return quantile_of(ms, 0.5);
}

Pose street_pose(double t) {
    Pose pose;
    pose.position = dvec3(400 * t - 200, 1.7, 37.0);
    pose.orientation = glm::angleAxis(std::numbers::pi * 2 * t, dvec3(0, 1, 0));
    return pose;
}

}  // namespace

int main() {
    // A town seen from above its edge, to the leaves: about 10^5 visible nodes.
    prepare::PrepareOptions deep;
    deep.full_depth = true;
    test::Scene wide(test::town(8, 6.0), deep);
    Pose above;
    above.position = dvec3(0, 400, 900);
    above.orientation = glm::angleAxis(-0.45, dvec3(1, 0, 0));
    wide.look({above, 0, 0});
    const std::size_t candidates = wide.frame.candidates.size();
    fmt::print("{{\"candidates\": {}, \"select_ms\": {{", candidates);
    const char* comma = "";
    const double full_us = static_cast<double>(wide.run("flat", test::infinity).predicted_us);
    for (const char* selector : {"depth-first", "best-first", "two-stage", "curve-budget", "threshold"}) {
        fmt::print("{}\"{}\": {{\"full\": {:.3f}, \"half\": {:.3f}, \"tenth\": {:.3f}}}", comma, selector,
                   select_ms(wide, selector, test::infinity), select_ms(wide, selector, 0.5 * full_us),
                   select_ms(wide, selector, 0.1 * full_us));
        comma = ", ";
    }
    // Walking through 1.4 million nodes.
    test::Scene town(test::town(10, 6.0));
    std::vector<double> visits, cpu_ms;
    for (int i = 0; i < 200; ++i) {
        town.look({street_pose(i / 200.0), 0.2, 0.02});
        visits.push_back(town.frame.visits);
        cpu_ms.push_back(town.frame.cpu_us * 1e-3);
    }
    fmt::print(
        "}}, \"prepare\": {{\"nodes\": {}, \"visits\": {{\"p50\": {:.0f}, \"p99\": {:.0f}}}, \"cpu_ms\": {{\"p50\": {:.3f}, "
        "\"p99\": {:.3f}}}}}}}\n",
        town.model.nodes.size(), quantile_of(visits, 0.5), quantile_of(visits, 0.99), quantile_of(cpu_ms, 0.5),
        quantile_of(cpu_ms, 0.99));
    return 0;
}
