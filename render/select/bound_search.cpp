// Best-first search over parts of a frame's problem.
#include "render/select/bound_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace surefoot::select {

void BoundSearch::restrict_to(const Part& part) {
    relaxation_.allow_all();
    const auto only = [&](std::uint32_t n, std::uint32_t decision) {
        const ProblemNode& node = problem_.nodes[n];
        for (std::uint32_t d = 0; d < node.decision_count; ++d)
            if (d != decision) relaxation_.forbid(node.first_decision + d);
    };
    for (const Restriction& r : part.restrictions) {
        if (!r.must) {
            relaxation_.forbid(problem_.nodes[r.node].first_decision + r.decision);
            continue;
        }
        only(r.node, r.decision);
        for (std::uint32_t n = problem_.nodes[r.node].parent; n != none; n = problem_.nodes[n].parent)
            only(n, problem_.nodes[n].decision_count - 1);
    }
}

double BoundSearch::solve(Part& part, double best, const Offer& offer) {
    restrict_to(part);
    if (!relaxation_.minimise_for(share_)) {
        part.bound = relaxation_.bound();
        return best;
    }
    part.bound = relaxation_.bound();
    part.divisible = relaxation_.find_tie(part.tie.node, part.tie.decision);
    return relaxation_.feasible().empty() ? best : std::max(best, offer(relaxation_.feasible()));
}

double BoundSearch::search(std::uint32_t max_parts, double best, const Offer& offer) {
    const auto smaller = [](const Part& a, const Part& b) { return a.bound < b.bound; };
    std::vector<Part> parts(1);
    best = solve(parts.front(), best, offer);
    double indivisible = -std::numeric_limits<double>::infinity();  // greatest bound of parts that cannot be split
    for (std::uint32_t split = 0; split < max_parts && !parts.empty(); ++split) {
        if (parts.front().bound <= best + 1e-7 * std::abs(best) || parts.front().bound <= indivisible) break;
        std::pop_heap(parts.begin(), parts.end(), smaller);
        const Part whole = std::move(parts.back());
        parts.pop_back();
        if (!whole.divisible) {
            indivisible = std::max(indivisible, whole.bound);
            continue;
        }
        for (const bool must : {true, false}) {
            Part half;
            half.restrictions = whole.restrictions;
            half.restrictions.push_back({whole.tie.node, whole.tie.decision, must});
            best = solve(half, best, offer);
            half.bound = std::min(half.bound, whole.bound);
            parts.push_back(std::move(half));
            std::push_heap(parts.begin(), parts.end(), smaller);
        }
    }
    relaxation_.allow_all();
    return std::max({best, indivisible, parts.empty() ? best : parts.front().bound});
}

}  // namespace surefoot::select
