// Finds cards by their edges, and orders them: always the farthest from all before it (cards.hpp).
#include "render/bake/cards.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>

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

Cards cards_of(const Geometry& g, const GeometryPart& part) {
    std::map<std::tuple<float, float, float>, std::uint32_t> places;
    std::vector<std::uint32_t> place;
    place.reserve(part.indices.size());
    for (const std::uint32_t index : part.indices) {
        const float* p = g.vertices[index].position;
        place.push_back(places.try_emplace({p[0], p[1], p[2]}, static_cast<std::uint32_t>(places.size())).first->second);
    }
    const auto count = static_cast<std::uint32_t>(place.size() / 3);
    Sets triangles(count);
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> edges;  // and the first triangle at it
    for (std::uint32_t t = 0; t < count; ++t) {
        for (std::uint32_t k = 0; k < 3; ++k) {
            const std::uint32_t from = place[3 * t + k], to = place[3 * t + (k + 1) % 3];
            triangles.join(t, edges.try_emplace({std::min(from, to), std::max(from, to)}, t).first->second);
        }
    }
    std::map<std::uint32_t, std::vector<std::uint32_t>> by_root;
    for (std::uint32_t t = 0; t < count; ++t) {
        std::vector<std::uint32_t>& card = by_root[triangles.root(t)];
        const auto first = part.indices.begin() + static_cast<std::ptrdiff_t>(3) * t;
        card.insert(card.end(), first, first + 3);
    }
    Cards cards;
    cards.reserve(by_root.size());
    for (auto& [root, card] : by_root) cards.push_back(std::move(card));
    return cards;
}

Cards thinnable_cards(const Geometry& g, const GeometryPart& part) {
    Cards cards = cards_of(g, part);
    const bool large = std::any_of(cards.begin(), cards.end(), [&](const std::vector<std::uint32_t>& card) {
        return static_cast<double>(card.size()) > largest_card_share * static_cast<double>(part.indices.size());
    });
    if (large || cards.size() < fewest_cards) cards.clear();
    return cards;
}

Cards single_triangles(const GeometryPart& part) {
    Cards cards;
    for (auto at = part.indices.begin(); at != part.indices.end(); at += 3) cards.emplace_back(at, at + 3);
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

void spread(const Geometry& g, Cards& cards, std::size_t max_triangles) {
    struct Place {
        vec3 middle;
        float size_factor;  ///< less for a larger one
        float away;         ///< from those that are kept
    };
    std::vector<Place> places;
    places.reserve(cards.size());
    Box all;
    std::size_t triangles = 0;
    for (const std::vector<std::uint32_t>& card : cards) {
        Box box;
        for (const std::uint32_t index : card) box.grow(dvec3(position_of(g.vertices[index])));
        places.push_back({vec3(box.centre()), 1 / std::sqrt(static_cast<float>(card.size())), 0});
        all.grow(box.centre());
        triangles += card.size() / 3;
    }
    // At first the middle one, of those that are not large: it is in every level.
    const vec3 middle(all.centre());
    std::size_t next = 0;
    for (std::size_t i = 0; i < cards.size(); ++i) {
        const bool large = cards[i].size() / 3 * fewest_cards > triangles;
        places[i].away = -glm::length(places[i].middle - middle) - (large ? 1e30F : 0.0F);
        if (places[i].away > places[next].away) next = i;
    }
    std::size_t ordered = 0;
    for (std::size_t kept = 0; kept < cards.size() && ordered < max_triangles; ++kept) {
        std::swap(cards[kept], cards[next]);
        std::swap(places[kept], places[next]);
        ordered += cards[kept].size() / 3;
        next = kept + 1;
        for (std::size_t i = kept + 1; i < cards.size(); ++i) {
            Place& place = places[i];
            const float from = glm::length(place.middle - places[kept].middle) * place.size_factor;
            place.away = kept == 0 ? from : std::min(place.away, from);
            if (place.away > places[next].away) next = i;
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

void enlarge_cards(Geometry& g, GeometryPart& part, const Cards& cards, double area_m2, double largest) {
    const double now_m2 = area_of(g, part.indices);
    if (!(now_m2 > 0) || !(area_m2 > now_m2)) return;
    const double scale = std::min(largest, std::sqrt(area_m2 / now_m2));
    std::size_t first = 0;
    for (const std::vector<std::uint32_t>& card : cards) {
        if (first >= part.indices.size()) return;
        const std::span<std::uint32_t> own = std::span(part.indices).subspan(first, card.size());
        first += card.size();
        dvec3 middle(0.0);
        for (const std::uint32_t index : own) middle += dvec3(position_of(g.vertices[index])) / static_cast<double>(own.size());
        std::map<std::uint32_t, std::uint32_t> moved;  // a card's own: another that shares a vertex moves it elsewhere
        for (std::uint32_t& index : own) {
            const auto [where, fresh] = moved.try_emplace(index, static_cast<std::uint32_t>(g.vertices.size()));
            if (fresh) {
                model::Vertex v = g.vertices[index];
                const dvec3 at = middle + scale * (dvec3(position_of(v)) - middle);
                for (int k = 0; k < 3; ++k) v.position[k] = static_cast<float>(at[k]);
                g.vertices.push_back(v);
                const std::array<std::uint8_t, 4> colour = g.baked[index];
                g.baked.push_back(colour);
            }
            index = where->second;
        }
    }
}

}  // namespace surefoot::bake
