// Cards by places, and those first that lie farthest from all before (cards.hpp).
#include "render/bake/cards.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>
#include <tuple>

namespace surefoot::bake {

namespace {

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

namespace {

using Cards = std::vector<std::vector<std::uint32_t>>;

/// Runs of triangles that share what `key` says of a vertex.
template <class Key>
Cards connected(const std::vector<std::uint32_t>& indices, Key key) {
    std::map<decltype(key(0U)), std::uint32_t> numbers;
    std::vector<std::uint32_t> place;
    place.reserve(indices.size());
    for (const std::uint32_t index : indices)
        place.push_back(numbers.try_emplace(key(index), static_cast<std::uint32_t>(numbers.size())).first->second);
    Sets sets(numbers.size());
    for (std::size_t i = 0; i + 2 < place.size(); i += 3) {
        sets.join(place[i], place[i + 1]);
        sets.join(place[i], place[i + 2]);
    }
    std::map<std::uint32_t, std::vector<std::uint32_t>> by_root;
    for (std::size_t i = 0; i + 2 < place.size(); i += 3) {
        std::vector<std::uint32_t>& card = by_root[sets.root(place[i])];
        card.insert(card.end(), indices.begin() + static_cast<std::ptrdiff_t>(i),
                    indices.begin() + static_cast<std::ptrdiff_t>(i) + 3);
    }
    Cards cards;
    cards.reserve(by_root.size());
    for (auto& [root, card] : by_root) cards.push_back(std::move(card));
    return cards;
}

}  // namespace

Cards cards_of(const Geometry& g, const GeometryPart& part) {
    return connected(part.indices, [&](std::uint32_t index) {
        const float* p = g.vertices[index].position;
        return std::tuple(p[0], p[1], p[2]);
    });
}

Cards thinnable_cards(const Geometry& g, const GeometryPart& part) {
    Cards cards;
    for (std::vector<std::uint32_t>& card : cards_of(g, part)) {
        if (card.size() * fewest_cards <= part.indices.size()) {
            cards.push_back(std::move(card));
            continue;
        }
        Cards apart = connected(card, [&](std::uint32_t index) {
            const model::Vertex& v = g.vertices[index];
            return std::tuple(v.position[0], v.position[1], v.position[2], v.uv[0], v.uv[1]);
        });
        std::move(apart.begin(), apart.end(), std::back_inserter(cards));
    }
    const bool large = std::any_of(cards.begin(), cards.end(), [&](const std::vector<std::uint32_t>& card) {
        return static_cast<double>(card.size()) > largest_card_share * static_cast<double>(part.indices.size());
    });
    if (large || cards.size() < fewest_cards) cards.clear();
    return cards;
}

double area_of(const Geometry& g, const std::vector<std::uint32_t>& indices) {
    double area = 0;
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
        const auto at = [&](std::size_t k) { return dvec3(position_of(g.vertices[indices[i + k]])); };
        area += 0.5 * glm::length(glm::cross(at(1) - at(0), at(2) - at(0)));
    }
    return area;
}

void spread(const Geometry& g, Cards& cards, std::size_t most_triangles) {
    std::vector<vec3> middles;
    middles.reserve(cards.size());
    Box all;
    for (const std::vector<std::uint32_t>& card : cards) {
        Box box;
        for (const std::uint32_t index : card) box.grow(dvec3(position_of(g.vertices[index])));
        middles.emplace_back(box.centre());
        all.grow(box.centre());
    }
    std::vector<float> away(cards.size());  // from those that are kept; at first less for what is farther out
    for (std::size_t i = 0; i < cards.size(); ++i) away[i] = -glm::length(middles[i] - vec3(all.centre()));
    std::size_t triangles = 0;
    for (std::size_t kept = 0; kept < cards.size() && triangles < most_triangles; ++kept) {
        const auto next = static_cast<std::size_t>(
            std::max_element(away.begin() + static_cast<std::ptrdiff_t>(kept), away.end()) - away.begin());
        std::swap(cards[kept], cards[next]);
        std::swap(middles[kept], middles[next]);
        std::swap(away[kept], away[next]);
        triangles += cards[kept].size() / 3;
        for (std::size_t i = kept + 1; i < cards.size(); ++i) {
            const float from = glm::length(middles[i] - middles[kept]) / std::sqrt(static_cast<float>(cards[i].size()));
            away[i] = kept == 0 ? from : std::min(away[i], from);
        }
    }
}

std::vector<std::uint32_t> some_cards(const Cards& cards, double share) {
    std::size_t all = 0;
    for (const auto& card : cards) all += card.size();
    std::vector<std::uint32_t> kept;
    for (const std::vector<std::uint32_t>& card : cards) {
        if (!kept.empty() && static_cast<double>(kept.size() + card.size()) > share * static_cast<double>(all)) break;
        kept.insert(kept.end(), card.begin(), card.end());
    }
    return kept;
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
