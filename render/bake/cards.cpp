// Cards by places, in a scattered order (cards.hpp).
#include "render/bake/cards.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>

namespace surefoot::bake {

namespace {

/// Neighbours in the file are neighbours in the tree: every bit of the number counts.
std::uint32_t scattered(std::uint32_t x) {
    x = (x ^ (x >> 16U)) * 0x7feb352dU;
    x = (x ^ (x >> 15U)) * 0x846ca68bU;
    return x ^ (x >> 16U);
}

class Sets {
public:
    explicit Sets(std::size_t count) : of_(count) { std::iota(of_.begin(), of_.end(), 0U); }
    std::uint32_t root(std::uint32_t i) {
        while (of_[i] != i) i = of_[i] = of_[of_[i]];
        return i;
    }
    void join(std::uint32_t a, std::uint32_t b) {
        const std::uint32_t ra = root(a), rb = root(b);
        of_[std::max(ra, rb)] = std::min(ra, rb);
    }

private:
    std::vector<std::uint32_t> of_;
};

}  // namespace

std::vector<std::vector<std::uint32_t>> cards_of(const Geometry& g, const GeometryPart& part) {
    std::map<std::tuple<float, float, float>, std::uint32_t> places;
    std::vector<std::uint32_t> place;
    place.reserve(part.indices.size());
    for (const std::uint32_t index : part.indices) {
        const float* p = g.vertices[index].position;
        place.push_back(places.try_emplace({p[0], p[1], p[2]}, static_cast<std::uint32_t>(places.size())).first->second);
    }
    Sets sets(places.size());
    for (std::size_t i = 0; i + 2 < place.size(); i += 3) {
        sets.join(place[i], place[i + 1]);
        sets.join(place[i], place[i + 2]);
    }
    std::map<std::uint32_t, std::vector<std::uint32_t>> by_root;
    for (std::size_t i = 0; i + 2 < place.size(); i += 3) {
        std::vector<std::uint32_t>& card = by_root[sets.root(place[i])];
        card.insert(card.end(), part.indices.begin() + static_cast<std::ptrdiff_t>(i),
                    part.indices.begin() + static_cast<std::ptrdiff_t>(i) + 3);
    }
    std::vector<std::vector<std::uint32_t>> cards;
    cards.reserve(by_root.size());
    for (auto& [root, card] : by_root) cards.push_back(std::move(card));
    return cards;
}

std::vector<std::uint32_t> some_cards(const std::vector<std::vector<std::uint32_t>>& cards, double share) {
    std::vector<std::uint32_t> order(cards.size());
    std::iota(order.begin(), order.end(), 0U);
    const auto first = [&](std::uint32_t card) { return std::pair(scattered(card), card); };
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return first(a) < first(b); });
    std::size_t all = 0;
    for (const auto& card : cards) all += card.size();
    std::vector<std::uint32_t> kept;
    for (const std::uint32_t card : order) {
        if (!kept.empty() && static_cast<double>(kept.size() + cards[card].size()) > share * static_cast<double>(all)) break;
        kept.insert(kept.end(), cards[card].begin(), cards[card].end());
    }
    return kept;
}

double area_of(const Geometry& g, const std::vector<std::uint32_t>& indices) {
    double area = 0;
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
        const auto at = [&](std::size_t k) { return dvec3(position_of(g.vertices[indices[i + k]])); };
        area += 0.5 * glm::length(glm::cross(at(1) - at(0), at(2) - at(0)));
    }
    return area;
}

void enlarge_cards(Geometry& g, GeometryPart& part, double area_m2, double largest) {
    const double now_m2 = area_of(g, part.indices);
    if (!(now_m2 > 0) || !(area_m2 > now_m2)) return;
    const double scale = std::min(largest, std::sqrt(area_m2 / now_m2));
    const std::vector<std::vector<std::uint32_t>> cards = cards_of(g, part);
    std::map<std::uint32_t, std::uint32_t> moved;
    part.indices.clear();
    for (const std::vector<std::uint32_t>& card : cards) {
        dvec3 middle(0.0);
        for (const std::uint32_t index : card) middle += dvec3(position_of(g.vertices[index])) / static_cast<double>(card.size());
        for (const std::uint32_t index : card) {
            const auto [where, fresh] = moved.try_emplace(index, static_cast<std::uint32_t>(g.vertices.size()));
            if (fresh) {
                model::Vertex v = g.vertices[index];
                const dvec3 at = middle + scale * (dvec3(position_of(v)) - middle);
                for (int k = 0; k < 3; ++k) v.position[k] = static_cast<float>(at[k]);
                g.vertices.push_back(v);
                const std::array<std::uint8_t, 4> colour = g.baked[index];
                g.baked.push_back(colour);
            }
            part.indices.push_back(where->second);
        }
    }
}

}  // namespace surefoot::bake
