// Bench: do the error bounds of coarse forms hold, and how near are they to the true distances? Samples on both surfaces find
// distances, and none may lie beyond the bound. Of the meshes that a model places, so many are judged, evenly spread, each once.
// Full detail and what is cut to its masks are left out.
//
// bench_bounds MODEL.walk [MESHES 200] [POINTS 100000] -> one JSON object. It takes a minute or more.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "render/model/walk_file.hpp"
#include "tests/bake/surface.hpp"

using namespace surefoot;

int main(int argc, char** argv) {
    if (argc < 2) return fmt::print(stderr, "bench_bounds MODEL.walk [MESHES] [POINTS]\n"), 2;
    const auto number = [&](int i, long usual) { return argc > i ? std::max(1L, std::atol(argv[i])) : usual; };
    auto m = model::read_walk(argv[1]);
    if (!m) return fmt::print(stderr, "{}\n", m.error().text()), 1;
    const std::vector<model::Index> leaves = bake::distinct_leaves(*m, static_cast<std::size_t>(number(2, 200)));
    std::vector<std::vector<bake::Judged>> judged(leaves.size());
    std::atomic<std::size_t> next{0};
    std::vector<std::thread> threads;
    for (unsigned t = 0; t < std::max(1U, std::thread::hardware_concurrency()); ++t)
        threads.emplace_back([&] {
            for (std::size_t i = next++; i < leaves.size(); i = next++)
                judged[i] = bake::judge_node(*m, leaves[i], static_cast<std::size_t>(number(3, 100000)));
        });
    for (std::thread& thread : threads) thread.join();
    std::vector<double> ratios;
    std::size_t beyond = 0;
    for (const auto& of_leaf : judged) {
        for (const bake::Judged& j : of_leaf) {
            if (model::is_full_detail(m->nodes[j.node], j.rep, j.bound)) continue;
            if (j.sampled > j.bound + j.rounding) {
                const model::Representation& rep = m->reps[j.rep];
                fmt::print(stderr, "{}: {} of {} triangles, sampled {} m, bound {} m\n", m->name_of(m->nodes[j.node]),
                           model::form_of(rep.kind).name, rep.triangles, j.sampled, j.bound);
            }
            beyond += j.sampled > j.bound + j.rounding ? 1 : 0;
            ratios.push_back(static_cast<double>(j.bound) / std::max(static_cast<double>(j.sampled), 1e-12));
        }
    }
    std::sort(ratios.begin(), ratios.end());
    const auto quantile = [&](double q) {
        return ratios.empty()
                   ? std::string("null")
                   : fmt::format("{:.3f}", ratios[static_cast<std::size_t>(q * static_cast<double>(ratios.size() - 1))]);
    };
    fmt::print("{{\"model\": {}, \"meshes\": {}, \"forms\": {}, \"beyond\": {}, \"ratio_p50\": {}, \"ratio_p90\": {}}}\n",
               nlohmann::json(argv[1]).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace), leaves.size(),
               ratios.size(), ratios.empty() ? "null" : fmt::format("{}", beyond), quantile(0.5), quantile(0.9));
    return 0;
}
