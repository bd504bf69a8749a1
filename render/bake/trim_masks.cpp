// Polygons in texels: the hull of the texels that show, within the card; divided in two as long as that saves more than it costs.
#include "render/bake/trim_masks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <utility>

#include "render/bake/mesh_surface.hpp"

namespace surefoot::bake {

namespace {

using Polygon = std::vector<dvec2>;  // convex, counter-clockwise

constexpr std::size_t max_corners = 8;
constexpr int max_divisions = 4;
constexpr double overlap_texels = 0.25;
constexpr double max_repeats = 4;   // of a picture over a card each way: one that repeats it more often is left alone
constexpr double max_texel = 1e7;   // of a place: what lies farther has no exact texel
constexpr double min_saving = 0.1;  // of the area
constexpr double coarse_price = 0.04;

double cross(const dvec2& a, const dvec2& b) { return a.x * b.y - a.y * b.x; }

double area_of(const Polygon& p) {
    double doubled = 0;
    for (std::size_t i = 0; i < p.size(); ++i) doubled += cross(p[i], p[(i + 1) % p.size()]);
    return 0.5 * doubled;
}

/// What of a convex polygon has inside(p) >= 0; `inside` is linear.
template <class Inside>
Polygon clipped(const Polygon& p, const Inside& inside) {
    Polygon out;
    for (std::size_t i = 0; i < p.size(); ++i) {
        const dvec2 &a = p[i], &b = p[(i + 1) % p.size()];
        const double da = inside(a), db = inside(b);
        if (da >= 0) out.push_back(a);
        if ((da >= 0) != (db >= 0)) out.push_back(a + (b - a) * (da / (da - db)));
    }
    return out.size() < 3 ? Polygon() : out;
}

Polygon intersection(Polygon p, const Polygon& with) {
    for (std::size_t i = 0; i < with.size() && !p.empty(); ++i) {
        const dvec2 a = with[i], along = with[(i + 1) % with.size()] - a;
        p = clipped(p, [&](const dvec2& at) { return cross(along, at - a); });
    }
    return p;
}

Polygon hull_of(Polygon points) {
    std::sort(points.begin(), points.end(), [](const dvec2& a, const dvec2& b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
    points.erase(std::unique(points.begin(), points.end()), points.end());
    if (points.size() < 3) return {};
    Polygon hull(2 * points.size());
    std::size_t count = 0;
    const auto add = [&](const dvec2& p, std::size_t from) {
        while (count >= from + 2 && cross(hull[count - 1] - hull[count - 2], p - hull[count - 2]) <= 0) --count;
        hull[count++] = p;
    };
    for (const dvec2& p : points) add(p, 0);
    const std::size_t upper = count - 1;
    for (std::size_t i = points.size() - 1; i-- > 0;) add(points[i], upper);
    hull.resize(count - 1);
    return hull;
}

/// Fewer corners and a little more area: the edge goes whose neighbours, made longer, add least.
void simplify(Polygon& p) {
    while (p.size() > max_corners) {
        const std::size_t n = p.size();
        double min_more = 1e300;
        std::size_t edge = n;
        dvec2 corner(0);
        for (std::size_t i = 0; i < n; ++i) {  // the edge from i to i + 1
            const dvec2 &before = p[(i + n - 1) % n], &a = p[i], &b = p[(i + 1) % n], &after = p[(i + 2) % n];
            const dvec2 u = a - before, v = b - after;
            const double turn = cross(u, v);
            if (!(turn < -1e-12)) continue;  // the neighbours do not meet outside
            const double t = cross(b - a, v) / turn;
            if (!(t > 0)) continue;
            const dvec2 meet = a + u * t;
            const double more = 0.5 * std::abs(cross(b - a, meet - a));
            if (more < min_more) min_more = more, edge = i, corner = meet;
        }
        if (edge == n) return;
        p[edge] = corner;
        p.erase(p.begin() + static_cast<std::ptrdiff_t>((edge + 1) % n));
    }
}

/// Polygons over one picture.
class Cutter {
public:
    Cutter(const MaskShape& shape, double corner_price) : shape_(shape), corner_price_(corner_price) {}

    /// Pieces that together hold all that shows within `card`.
    [[nodiscard]] std::vector<Polygon> pieces(const Polygon& card) const {
        std::vector<Polygon> out;
        divide(what_shows(card), 0, out);
        return out;
    }
    /// Area, and what its triangles cost.
    [[nodiscard]] double price(const Polygon& p) const {
        return p.empty() ? 0.0 : area_of(p) + corner_price_ * static_cast<double>(p.size() - 2);
    }

private:
    static std::int64_t repeat_of(std::int64_t i, std::uint32_t n) { return i >= 0 ? i / n : -((n - 1 - i) / n); }
    [[nodiscard]] std::size_t row_of(std::int64_t y) const {
        return static_cast<std::size_t>(y - repeat_of(y, shape_.height) * shape_.height) * shape_.width;
    }
    /// The first texel of a row that shows, within [first, last]; last + 1: none does.
    [[nodiscard]] std::int64_t first_shown(std::int64_t y, std::int64_t first, std::int64_t last) const {
        for (std::int64_t begin = repeat_of(first, shape_.width) * shape_.width; begin <= last; begin += shape_.width) {
            const std::uint16_t x = shape_.next[row_of(y) + static_cast<std::size_t>(std::max(first - begin, std::int64_t{0}))];
            if (x < shape_.width) return std::min(begin + x, last + 1);
        }
        return last + 1;
    }
    [[nodiscard]] std::int64_t last_shown(std::int64_t y, std::int64_t first, std::int64_t last) const {
        for (std::int64_t begin = repeat_of(last, shape_.width) * shape_.width; begin + shape_.width > first;
             begin -= shape_.width) {
            const std::int64_t at = std::min(last - begin, std::int64_t{shape_.width} - 1);
            const std::uint16_t x = shape_.last[row_of(y) + static_cast<std::size_t>(at)];
            if (x < shape_.width) return begin + x;
        }
        return first;
    }
    /// The hull of the texels that show and touch the polygon, within the polygon.
    [[nodiscard]] Polygon what_shows(const Polygon& p) const {
        if (p.empty()) return {};
        dvec2 low(1e300), high(-1e300);
        for (const dvec2& at : p) low = glm::min(low, at), high = glm::max(high, at);
        Polygon corners;
        for (auto y = static_cast<std::int64_t>(std::floor(low.y)); static_cast<double>(y) < high.y; ++y) {
            const auto row = static_cast<double>(y);
            double left = 1e300, right = -1e300;  // of the polygon in this row
            const auto reach = [&](const dvec2& at) { left = std::min(left, at.x), right = std::max(right, at.x); };
            for (std::size_t i = 0; i < p.size(); ++i) {
                const dvec2 &a = p[i], &b = p[(i + 1) % p.size()];
                if (a.y >= row && a.y <= row + 1) reach(a);
                for (const double line : {row, row + 1})
                    if ((a.y < line) != (b.y < line)) reach(a + (b - a) * ((line - a.y) / (b.y - a.y)));
            }
            if (!(right >= left)) continue;
            auto first = static_cast<std::int64_t>(std::floor(left)), last = static_cast<std::int64_t>(std::ceil(right)) - 1;
            first = first_shown(y, first, last);
            if (first > last) continue;
            last = last_shown(y, first, last);
            for (const double at : {row, row + 1})
                for (const std::int64_t x : {first, last + 1}) corners.emplace_back(static_cast<double>(x), at);
        }
        Polygon hull = hull_of(std::move(corners));
        simplify(hull);
        return intersection(std::move(hull), p);
    }
    void divide(Polygon p, int depth, std::vector<Polygon>& out) const {
        if (p.empty() || !(area_of(p) > 0)) return;
        if (depth < max_divisions) {
            dvec2 low(1e300), high(-1e300);
            for (const dvec2& at : p) low = glm::min(low, at), high = glm::max(high, at);
            double best = price(p);
            std::array<Polygon, 2> halves;
            bool divided = false;
            for (int axis = 0; axis < 2; ++axis) {
                for (const double share : {0.35, 0.5, 0.65}) {
                    const double line = low[axis] + share * (high[axis] - low[axis]);
                    const auto before = [&](const dvec2& at) { return line + overlap_texels - at[axis]; };
                    const auto behind = [&](const dvec2& at) { return at[axis] - line + overlap_texels; };
                    std::array<Polygon, 2> now{what_shows(clipped(p, before)), what_shows(clipped(p, behind))};
                    const double sum = price(now[0]) + price(now[1]);
                    if (sum < best) best = sum, halves = std::move(now), divided = true;
                }
            }
            if (divided) {
                for (Polygon& half : halves) divide(std::move(half), depth + 1, out);
                return;
            }
        }
        out.push_back(std::move(p));
    }

    const MaskShape& shape_;
    double corner_price_;
};

/// A triangle, or two that lie in one plane and show one picture: corners in order, and their places in texels.
struct Card {
    std::array<std::uint32_t, 4> corners{};
    std::size_t count = 3;
    std::array<dvec2, 4> at{};
    [[nodiscard]] std::size_t triangles() const { return count - 2; }
};

class Trimmer {
public:
    Trimmer(Geometry& g, const MaskShape& shape, const TrimPrice& price) : g_(g), shape_(shape), price_(price) {}

    void cut(const GeometryPart& part, GeometryPart& to) {
        for (const Card& card : cards_of(part)) cut(card, to);
    }
    double area = 0, left = 0;  ///< in metres^2: before, and after with the price of triangles

private:
    [[nodiscard]] dvec2 texel_of(std::uint32_t vertex) const {
        const float* uv = g_.vertices[vertex].uv;
        return {static_cast<double>(uv[0]) * shape_.width, static_cast<double>(uv[1]) * shape_.height};
    }
    [[nodiscard]] dvec3 place_of(std::uint32_t vertex) const { return dvec3(position_of(g_.vertices[vertex])); }
    [[nodiscard]] std::vector<Card> cards_of(const GeometryPart& part) const;
    [[nodiscard]] std::optional<Card> joined(const Card& a, std::span<const std::uint32_t> b) const;
    [[nodiscard]] bool continues(std::uint32_t opposite, std::uint32_t from, std::uint32_t to, std::uint32_t other, double s,
                                 double t) const;
    void cut(const Card& card, GeometryPart& to);
    void keep(const Card& card, GeometryPart& to) const {
        for (std::size_t k = 0; k < card.triangles(); ++k)
            for (const std::size_t corner : {std::size_t{0}, k + 1, k + 2}) to.indices.push_back(card.corners[corner]);
    }
    std::uint32_t vertex_at(const Card& card, const dvec2& at);

    Geometry& g_;
    const MaskShape& shape_;
    TrimPrice price_;
    std::map<std::vector<double>, std::vector<Polygon>> pieces_of_;  ///< by outline
};

/// The card of both triangles, if they share an edge, lie in one plane and show one picture.
std::optional<Card> Trimmer::joined(const Card& a, std::span<const std::uint32_t> b) const {
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            const std::uint32_t from = a.corners[i], to = a.corners[(i + 1) % 3], opposite = a.corners[(i + 2) % 3];
            if (b[j] != to || b[(j + 1) % 3] != from) continue;
            const std::uint32_t other = b[(j + 2) % 3];
            const dvec3 origin = place_of(opposite), u = place_of(from) - origin, v = place_of(to) - origin;
            const dvec3 normal = glm::cross(u, v), w = place_of(other) - origin;
            const double square = glm::dot(normal, normal);
            if (!(square > 0) || std::abs(glm::dot(w, normal)) > 1e-5 * glm::length(normal) * glm::length(w)) return {};
            const double s = glm::dot(glm::cross(w, v), normal) / square, t = glm::dot(glm::cross(u, w), normal) / square;
            const dvec2 texel =
                texel_of(opposite) + s * (texel_of(from) - texel_of(opposite)) + t * (texel_of(to) - texel_of(opposite));
            // Not convex, another picture, or other colours and normals than these go on to.
            if (s <= 0 || t <= 0 || s + t <= 1 || glm::length(texel - texel_of(other)) > 0.05) return {};
            if (!continues(opposite, from, to, other, s, t)) return {};
            Card card;
            card.corners = {opposite, from, other, to};
            card.count = 4;
            return card;
        }
    }
    return {};
}

/// Whether colour and normal of `other` are what those of the other three make them there, but for rounding.
bool Trimmer::continues(std::uint32_t opposite, std::uint32_t from, std::uint32_t to, std::uint32_t other, double s,
                        double t) const {
    const model::Vertex &o = g_.vertices[opposite], &a = g_.vertices[from], &b = g_.vertices[to], &d = g_.vertices[other];
    const auto off = [&](int oo, int aa, int bb, int dd) { return std::abs(oo + s * (aa - oo) + t * (bb - oo) - dd); };
    for (std::size_t k = 0; k < 4; ++k) {
        if (off(o.colour[k], a.colour[k], b.colour[k], d.colour[k]) > 3) return false;
        if (k < 3 && off(o.normal[k], a.normal[k], b.normal[k], d.normal[k]) > 3) return false;
    }
    return true;
}

std::vector<Card> Trimmer::cards_of(const GeometryPart& part) const {
    std::vector<Card> cards;
    for (std::size_t i = 0; i + 2 < part.indices.size(); i += 3) {
        Card card;
        std::copy_n(part.indices.begin() + static_cast<std::ptrdiff_t>(i), 3, card.corners.begin());
        if (i + 5 < part.indices.size()) {
            if (const auto both = joined(card, std::span(part.indices).subspan(i + 3, 3)); both) {
                card = *both;
                i += 3;
            }
        }
        for (std::size_t k = 0; k < card.count; ++k) card.at[k] = texel_of(card.corners[k]);
        cards.push_back(card);
    }
    return cards;
}

/// In the triangle of the card that holds the place, or is nearest to it.
std::uint32_t Trimmer::vertex_at(const Card& card, const dvec2& at) {
    std::array<double, 3> weights{};
    std::array<std::uint32_t, 3> of{};
    double max_inside = -1e300;
    for (std::size_t k = 0; k < card.triangles(); ++k) {
        const dvec2 &a = card.at[0], &b = card.at[k + 1], &c = card.at[k + 2];
        const double whole = cross(b - a, c - a), wb = cross(at - a, c - a) / whole, wc = cross(b - a, at - a) / whole;
        const double inside = std::min({1 - wb - wc, wb, wc});
        if (!(inside > max_inside)) continue;
        max_inside = inside;
        weights = {1 - wb - wc, wb, wc};
        of = {card.corners[0], card.corners[k + 1], card.corners[k + 2]};
    }
    for (std::size_t k = 0; k < 3; ++k)
        if (weights[k] > 1 - 1e-9) return of[k];
    const auto mixed = [&](const auto& value_of) {
        double sum = 0;
        for (std::size_t k = 0; k < 3; ++k) sum += weights[k] * static_cast<double>(value_of(of[k]));
        return sum;
    };
    const auto rounded = [](double value, double low, double high) { return std::lround(std::clamp(value, low, high)); };
    model::Vertex v{};
    for (int k = 0; k < 3; ++k) {
        v.position[k] = static_cast<float>(mixed([&](std::uint32_t i) { return g_.vertices[i].position[k]; }));
        v.normal[k] =
            static_cast<std::int8_t>(rounded(mixed([&](std::uint32_t i) { return g_.vertices[i].normal[k]; }), -127, 127));
    }
    std::array<std::uint8_t, 4> baked{};
    for (std::size_t k = 0; k < 4; ++k) {
        v.colour[k] =
            static_cast<std::uint8_t>(rounded(mixed([&](std::uint32_t i) { return g_.vertices[i].colour[k]; }), 0, 255));
        baked[k] = static_cast<std::uint8_t>(rounded(mixed([&](std::uint32_t i) { return g_.baked[i][k]; }), 0, 255));
    }
    v.uv[0] = static_cast<float>(at.x / shape_.width);
    v.uv[1] = static_cast<float>(at.y / shape_.height);
    g_.vertices.push_back(v);
    g_.baked.push_back(baked);
    return static_cast<std::uint32_t>(g_.vertices.size() - 1);
}

void Trimmer::cut(const Card& card, GeometryPart& to) {
    double card_m2 = 0;
    for (std::size_t k = 0; k < card.triangles(); ++k) {
        const dvec3 a = place_of(card.corners[0]);
        card_m2 += 0.5 * glm::length(glm::cross(place_of(card.corners[k + 1]) - a, place_of(card.corners[k + 2]) - a));
    }
    area += card_m2;
    Polygon outline(card.at.begin(), card.at.begin() + static_cast<std::ptrdiff_t>(card.count));
    const double turned = area_of(outline), texels = std::abs(turned);
    dvec2 low(1e300), high(-1e300);
    for (const dvec2& at : outline) low = glm::min(low, at), high = glm::max(high, at);
    const dvec2 size = high - low;
    const bool near = std::max({-low.x, -low.y, high.x, high.y}) < max_texel;
    const bool seldom = size.x <= max_repeats * shape_.width && size.y <= max_repeats * shape_.height;
    if (!(texels > 1) || !near || !seldom) {  // NaN too
        left += card_m2;
        return keep(card, to);
    }
    if (turned < 0) std::reverse(outline.begin(), outline.end());
    const Cutter cutter(shape_, price_.of_card * texels);
    // Most cards show the same part of their picture, or the same of another repeat.
    const dvec2 picture(shape_.width, shape_.height), repeat = glm::floor(low / picture) * picture;
    for (dvec2& at : outline) at -= repeat;
    std::vector<double> key;
    for (const dvec2& at : outline) key.insert(key.end(), {at.x, at.y});
    const auto [known, fresh] = pieces_of_.try_emplace(std::move(key));
    if (fresh) known->second = cutter.pieces(outline);
    const std::vector<Polygon>& pieces = known->second;
    double sum = 0;
    for (const Polygon& piece : pieces) sum += cutter.price(piece);
    sum -= price_.of_card * texels * static_cast<double>(card.triangles());  // the card has triangles too
    if (!(sum < (1 - min_saving) * texels)) {
        left += card_m2;
        return keep(card, to);
    }
    left += card_m2 * std::max(sum, 0.0) / texels;
    for (const Polygon& piece : pieces) {
        std::vector<std::uint32_t> corners;
        for (const dvec2& at : piece) corners.push_back(vertex_at(card, at + repeat));
        if (turned < 0) std::reverse(corners.begin(), corners.end());
        for (std::size_t k = 2; k < corners.size(); ++k)
            for (const std::uint32_t corner : {corners[0], corners[k - 1], corners[k]}) to.indices.push_back(corner);
    }
}

/// Error of a level that was cut from `before`: what was cut away counts, though nothing shows there. Of an object it is the
/// distance from full detail. Of a cluster, whose full detail is not at hand, the distance from the uncut level is added.
float error_of_cut(const LodChain& chain, const Level& before, const Level& cut) {
    const bool has_full = chain.levels.back().error_m == 0;
    const MeshSurface from(chain.full.vertices, has_full ? chain.levels.back().parts : before.parts);
    const measure::TriangleTree to(MeshSurface(chain.full.vertices, cut.parts).view());
    measure::DistanceLimits limits;
    limits.absolute = 0.0005F * to.diagonal();
    const float distance = measure::directed_distance(from.view(), to, limits).upper;
    return has_full ? std::max(before.error_m, distance) : before.error_m + distance;
}

}  // namespace

std::vector<GeometryPart> trimmed(Geometry& g, const std::vector<GeometryPart>& parts, const MaskShapes& shapes,
                                  const TrimPrice& price) {
    const std::size_t vertices = g.vertices.size();
    std::vector<GeometryPart> out;
    double area = 0, left = 0;
    for (const GeometryPart& part : parts) {
        const MaskShape* const shape = shapes.of(part.material);
        if (shape == nullptr) {
            out.push_back(part);
            continue;
        }
        Trimmer trimmer(g, *shape, price);
        GeometryPart cut{part.material, {}};
        trimmer.cut(part, cut);
        area += trimmer.area;
        left += trimmer.left;
        if (!cut.indices.empty()) out.push_back(std::move(cut));
    }
    if (left < (1 - min_saving) * area && !out.empty()) return out;
    g.vertices.resize(vertices);
    g.baked.resize(vertices);
    return {};
}

void trim_levels(LodChain& chain, const MaskShapes& shapes) {
    const auto count_of = [](const std::vector<GeometryPart>& parts) {
        std::size_t indices = 0;
        for (const GeometryPart& part : parts) indices += part.indices.size();
        return static_cast<std::uint32_t>(indices / 3);
    };
    // A level whose triangles stay between those of its neighbours.
    const auto cut = [&](const std::vector<GeometryPart>& parts, std::uint32_t above, std::uint32_t below,
                         const TrimPrice& price) {
        const std::size_t vertices = chain.full.vertices.size();
        Level level{trimmed(chain.full, parts, shapes, price), 0, 0};
        level.triangles = count_of(level.parts);
        if (!level.parts.empty() && level.triangles > above && level.triangles < below) return std::optional(std::move(level));
        chain.full.vertices.resize(vertices);
        chain.full.baked.resize(vertices);
        return std::optional<Level>();
    };
    std::uint32_t finer = ~0U;
    if (!chain.levels.empty() && chain.levels.back().error_m == 0) {
        const std::size_t last = chain.levels.size() - 1;
        finer = chain.levels[last].triangles;
        const bool only = last == 0, room = only || chain.levels[last - 1].error_m > model::trimmed_error_m;
        auto level = room ? cut(chain.levels[last].parts, only ? 0 : chain.levels[last - 1].triangles, ~0U, {}) : std::nullopt;
        if (level) {
            finer = level->triangles;
            level->error_m = model::trimmed_error_m;
            chain.levels.insert(chain.levels.end() - 1, std::move(*level));
        }
    }
    for (std::size_t i = chain.levels.size(); i-- > 1;) {  // the coarsest is for what is small
        Level& now = chain.levels[i];
        if (now.error_m <= model::trimmed_error_m) continue;
        if (auto level = cut(now.parts, chain.levels[i - 1].triangles, finer, {coarse_price}); level) {
            now.error_m = error_of_cut(chain, now, *level);
            now.parts = std::move(level->parts);
            now.triangles = level->triangles;
        }
        finer = now.triangles;
    }
    raise_errors(chain.levels);
}

}  // namespace surefoot::bake
