// Brings the upper bound of a large frame down: parts of the problem, each with a bound of its own. In this room only.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "render/select/relaxed_problem.hpp"

namespace surefoot::select {

/// The part of greatest bound is split at the node where its Lagrangian is undecided: either the dear decision there, or any
/// other. The greatest bound of all parts is one of the whole.
class BoundSearch {
public:
    /// offer: takes a solution that fits, a decision a node, and returns the value of the best so far.
    using Offer = std::function<double(const std::vector<std::uint32_t>& decision)>;

    BoundSearch(const Problem& problem, Relaxation& relaxation, double share)
        : problem_(problem), relaxation_(relaxation), share_(share) {}

    /// Splits up to `max_parts` parts, or until no part may be better than the best by a share of 10^-7. Returns the bound.
    double search(std::uint32_t max_parts, double best, const Offer& offer);

private:
    /// A node must, or must not, have a decision. A node that must have one is reached: all above it open.
    struct Restriction {
        std::uint32_t node = 0, decision = 0;
        bool must = false;
    };
    struct Part {
        double bound = 0;
        std::vector<Restriction> restrictions;
        Restriction tie;  ///< where it is split
        bool divisible = false;
    };
    void restrict_to(const Part& part);
    /// Bounds a part and finds its tie. Offers the best of its solutions that fits.
    double solve(Part& part, double best, const Offer& offer);

    const Problem& problem_;
    Relaxation& relaxation_;
    double share_;
};

}  // namespace surefoot::select
