// Figures, not tests: run with --gtest_also_run_disabled_tests --gtest_filter='*Speed*'. Medians over frames, CPU time.
#include <gtest/gtest.h>
#include <time.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tests/select/scene.hpp"

namespace surefoot::select {
namespace {

using test::infinity;
using test::Scene;

double cpu_us() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return 1e6 * static_cast<double>(t.tv_sec) + 1e-3 * static_cast<double>(t.tv_nsec);
}

double median(std::vector<double> v) {
    std::nth_element(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2), v.end());
    return v[v.size() / 2];
}

template <class Body>
double timed_us(int runs, const Body& body) {
    std::vector<double> all;
    for (int i = 0; i < runs; ++i) {
        const double start = cpu_us();
        body();
        all.push_back(cpu_us() - start);
    }
    return median(all);
}

TEST(Speed, DISABLED_SelectingAHundredThousandCandidates) {
    prepare::PrepareOptions options;
    options.full_depth = true;
    options.max_visits = 0;
    Scene s(test::town(9), options);
    prepare::Region region;
    region.centre.position = dvec3(0, 60, 700);
    region.centre.orientation = glm::angleAxis(-0.1, dvec3(1, 0, 0));
    s.look(region);
    const double n = static_cast<double>(s.frame.candidates.size());
    const double full = static_cast<double>(s.run("flat", infinity).predicted_us);
    std::printf("%zu candidates, %zu choices, prepared in %.2f ms CPU (%.0f ns a candidate)\n", s.frame.candidates.size(),
                s.frame.choices.size(), s.frame.cpu_us * 1e-3, 1e3 * s.frame.cpu_us / n);
    for (const std::string_view name : selector_names()) {
        for (const double share : {infinity, 0.5, 0.1, 0.01}) {
            s.run(name, share * full);
            const double us = timed_us(15, [&] { s.run(name, share * full); });
            const double plan = timed_us(5, [&] { plan_slices(s.input(share * full), s.cut, 1000, s.plan); });
            std::printf(
                "%-17s budget %4.2f of full: %6.0f us, %5.1f ns a candidate, %7u steps, %7zu items; %4zu slices in %5.0f us\n",
                std::string(name).c_str(), share, us, 1e3 * us / n, s.cut.refinements, s.cut.items.size(), s.plan.slices.size(),
                plan);
        }
    }
}

TEST(Speed, DISABLED_PreparingAMillionNodes) {
    prepare::PrepareOptions options;
    Scene s(test::town(10), options);
    Random random(3);
    std::vector<double> visits, cpu, candidates, cpu_of_visit;
    for (int i = 0; i < 300; ++i) {
        prepare::Region region;
        const double a = 0.02 * i;
        region.centre.position = dvec3(2000 * std::sin(a), 2 + 8 * random.unit(), 2000 * std::cos(a));
        region.centre.orientation = glm::angleAxis(a + 2 * random.unit(), dvec3(0, 1, 0));
        region.radius_m = 0.3;
        region.angle_rad = 0.03;
        s.look(region);
        visits.push_back(s.frame.visits);
        cpu.push_back(s.frame.cpu_us);
        candidates.push_back(static_cast<double>(s.frame.candidates.size()));
        cpu_of_visit.push_back(1e3 * s.frame.cpu_us / s.frame.visits);
    }
    std::printf("%zu nodes: median %.0f visits (%.2f %%), %.0f candidates, %.2f ms CPU, worst %.2f ms, %.0f ns a visit\n",
                s.model.nodes.size(), median(visits), 100 * median(visits) / static_cast<double>(s.model.nodes.size()),
                median(candidates), 1e-3 * median(cpu), 1e-3 * *std::max_element(cpu.begin(), cpu.end()), median(cpu_of_visit));
}

}  // namespace
}  // namespace surefoot::select
