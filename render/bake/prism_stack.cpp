// Profiles from pictures all round, heights by dynamic programming, and the triangles between them (prism_stack.hpp).
#include "render/bake/prism_stack.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace surefoot::bake {

namespace {

constexpr std::uint32_t profile_px = 64;       // about as many samples across a picture
constexpr double max_rows = 48, min_rows = 8;  // what has fewer pixels in height is flat
constexpr double square_from = 1.2;     // of the mean width along the diagonals, against that along the axes: a square has 1.41
constexpr double closed_from = 0.15;    // of the widest section: narrower ends stay open
constexpr double steepest_slope = 1.5;  // of normals

/// Sums what each view covers, by rows of one height.
class RowSums {
public:
    RowSums(double low, double height, std::size_t rows) : low_(low), height_(height), rows_(rows), middle_(rows), lines_(rows) {
        for (std::size_t r = 0; r < rows; ++r)
            rows_[r].height = low + height * (static_cast<double>(r) + 0.5) / static_cast<double>(rows);
    }

    void add(const FormPicture& p, std::size_t view) {
        const double pixel_m = std::ldexp(1.0, p.view.exponent);
        for (std::uint32_t y = 0; y < p.view.height; ++y) {
            const double height = static_cast<double>(p.view.low + y) * pixel_m;
            const double at = std::floor((height - low_) / height_ * static_cast<double>(rows_.size()));
            if (!(at >= 0) || !(at < static_cast<double>(rows_.size()))) continue;
            const auto r = static_cast<std::size_t>(at);
            lines_[r][view] += 1;
            for (std::uint32_t x = 0; x < p.view.width; ++x) {
                if (!p.samples[static_cast<std::size_t>(y) * p.view.width + x].covered()) continue;
                rows_[r].width[view] += pixel_m;
                middle_[r][view] += pixel_m * static_cast<double>(p.view.left + x) * pixel_m;
            }
        }
    }

    /// Each view sees the centre along its own right: the centre is the one that suits all views best. Where nothing shows, it is
    /// that of the row below, or of the first one that shows.
    std::vector<ProfileRow> finish(const std::array<FormPicture, profile_views>& pictures) && {
        std::vector<bool> known(rows_.size(), false);
        for (std::size_t r = 0; r < rows_.size(); ++r) {
            ProfileRow& row = rows_[r];
            glm::dmat2 axes(0.0);
            dvec2 sum(0.0);
            for (std::size_t k = 0; k < profile_views; ++k) {
                if (row.width[k] > 0) {
                    const vec3& right = pictures[k].view.direction.right;
                    const dvec2 along(right.x, right.z);
                    axes += glm::outerProduct(along, along);
                    sum += middle_[r][k] / row.width[k] * along;
                }
                row.width[k] /= std::max(lines_[r][k], 1.0);
                row.mean_width += row.width[k] / static_cast<double>(profile_views);
            }
            known[r] = glm::determinant(axes) > 0.1;
            if (known[r]) row.centre = glm::inverse(axes) * sum;
        }
        const auto first = std::find(known.begin(), known.end(), true);
        if (first == known.end()) return {};
        dvec2 centre = rows_[static_cast<std::size_t>(first - known.begin())].centre;
        for (std::size_t r = 0; r < rows_.size(); ++r) centre = rows_[r].centre = known[r] ? rows_[r].centre : centre;
        return std::move(rows_);
    }

private:
    double low_, height_;
    std::vector<ProfileRow> rows_;
    std::vector<std::array<double, profile_views>> middle_, lines_;  // sums of positions times widths; lines of pixels
};

/// How far the rows from a to b are off a straight line between these two: a length a row.
double off_line(const std::vector<ProfileRow>& rows, std::size_t a, std::size_t b) {
    double off = 0;
    for (std::size_t r = a; r <= b; ++r) {
        const double t = static_cast<double>(r - a) / static_cast<double>(b - a);
        const double width = rows[a].mean_width + t * (rows[b].mean_width - rows[a].mean_width);
        off += std::abs(width - rows[r].mean_width);
        if (!(rows[r].mean_width > 0) || !(width > 0)) continue;
        const dvec2 centre = rows[a].centre + t * (rows[b].centre - rows[a].centre);
        off += 2 * glm::length(centre - rows[r].centre) * std::min(1.0, rows[r].mean_width / width);
    }
    return off;
}

/// `count` rows, the first and the last among them, with the smallest sum of off_line() between neighbours.
std::vector<std::size_t> bends(const std::vector<ProfileRow>& rows, std::size_t count) {
    const std::size_t n = rows.size();
    constexpr double far = std::numeric_limits<double>::max();
    std::vector<double> best(n, far);  // of a line from the first row to this one, by so many pieces
    best[0] = 0;
    std::vector<std::vector<std::size_t>> before(count, std::vector<std::size_t>(n, 0));
    for (std::size_t c = 1; c < count; ++c) {
        std::vector<double> longer(n, far);
        for (std::size_t a = 0; a + 1 < n; ++a) {
            if (!(best[a] < far)) continue;
            for (std::size_t b = a + 1; b < n; ++b) {
                const double off = best[a] + off_line(rows, a, b);
                if (!(off < longer[b])) continue;
                longer[b] = off;
                before[c][b] = a;
            }
        }
        best = std::move(longer);
    }
    std::vector<std::size_t> out(count);
    std::size_t at = n - 1;
    for (std::size_t c = count; c-- > 0;) {
        out[c] = at;
        at = before[c][at];
    }
    return out;
}

/// Half of a section's extent along x and z, so that its mean width from all round is that of the row.
dvec2 half_of(const ProfileRow& row, const PrismStack& stack) {
    constexpr std::size_t quarter = profile_views / 4;  // the first view looks along z, and sees x
    const dvec2 wide = 0.5 * dvec2(row.width[0] + row.width[2 * quarter], row.width[quarter] + row.width[3 * quarter]);
    if (stack.square) return 0.5 * wide;
    const double mean = 0.5 * (wide.x + wide.y), n = stack.sides;
    if (!(mean > 0)) return dvec2(0.0);
    // A convex shape's mean width is its outline's length / pi; a polygon of radius 1 has 2 n sin(pi / n).
    const double radius = std::numbers::pi / (2 * n * std::sin(std::numbers::pi / n));
    return radius * row.mean_width / mean * wide;
}

/// Mean colour of what shows between two heights, in the middle half of the object.
std::optional<dvec3> colour_between(const FormPicture& p, double low, double high) {
    const double pixel_m = std::ldexp(1.0, p.view.exponent);
    dvec3 sum(0.0);
    double count = 0;
    for (std::uint32_t y = 0; y < p.view.height; ++y) {
        const double height = static_cast<double>(p.view.low + y) * pixel_m;
        if (height < low || height > high) continue;
        const FormSample* row = &p.samples[static_cast<std::size_t>(y) * p.view.width];
        std::uint32_t first = p.view.width, last = 0;
        for (std::uint32_t x = 0; x < p.view.width; ++x)
            if (row[x].covered()) first = std::min(first, x), last = x;
        if (first > last) continue;
        const std::uint32_t rim = (last - first) / 4;
        for (std::uint32_t x = first + rim; x <= last - rim; ++x) {
            if (!row[x].covered()) continue;
            sum += dvec3(row[x].rgb[1][0], row[x].rgb[1][1], row[x].rgb[1][2]);
            count += 1;
        }
    }
    if (!(count > 0)) return {};
    return sum / count;
}

/// Where the corners of a section are, from -1 to 1 along x and z.
dvec2 corner_of(const PrismStack& stack, std::uint32_t side) {
    if (stack.square) return {side == 0 || side == 3 ? 1.0 : -1.0, side < 2 ? 1.0 : -1.0};
    const double angle = 2 * std::numbers::pi * (side + 0.5) / stack.sides;
    return {std::cos(angle), std::sin(angle)};
}

/// The vertices of all rings, one ring after the other.
void add_vertices(Geometry& g, const PrismStack& stack, const Profile& profile, const dvec3& brightness) {
    const double half_row_m = 0.5 * (profile.rows[1].height - profile.rows[0].height);
    dvec3 colour(128.0);  // of the corner before, where nothing shows
    for (std::size_t i = 0; i < stack.rings.size(); ++i) {
        const PrismRing& ring = stack.rings[i];
        const PrismRing &below = stack.rings[i == 0 ? 0 : i - 1], &above = stack.rings[std::min(i + 1, stack.rings.size() - 1)];
        const double narrower = 0.5 * (below.half.x + below.half.y - above.half.x - above.half.y);
        const double slope = std::clamp(narrower / std::max(above.height - below.height, 1e-9), -steepest_slope, steepest_slope);
        const double low = profile.rows[ring.first_row].height - half_row_m;
        const double high = profile.rows[ring.end_row - 1].height + half_row_m;
        for (std::uint32_t s = 0; s < stack.sides; ++s) {
            const dvec2 c = corner_of(stack, s);
            const double turn = std::atan2(c.x, c.y) / (2 * std::numbers::pi) + 2;
            const auto view = static_cast<std::size_t>(std::lround(turn * profile_views)) % profile_views;
            if (const auto found = colour_between(profile.plain[view], low, high)) colour = *found;
            const dvec3 at = glm::clamp(dvec3(ring.centre.x + ring.half.x * c.x, ring.height, ring.centre.y + ring.half.y * c.y),
                                        profile.box.min, profile.box.max);
            const dvec3 normal = glm::normalize(dvec3(c.x, slope * glm::length(c), c.y));
            model::Vertex v{};
            v.colour[3] = 255;
            for (int k = 0; k < 3; ++k) {
                v.position[k] = static_cast<float>(at[k]);
                v.normal[k] = static_cast<std::int8_t>(std::lround(127 * normal[k]));
                v.colour[k] = static_cast<std::uint8_t>(std::lround(std::clamp(colour[k] * brightness[k], 0.0, 255.0)));
            }
            g.vertices.push_back(v);
            g.baked.push_back({v.colour[0], v.colour[1], v.colour[2], v.colour[3]});
        }
    }
}

}  // namespace

Profile profile_of(const Geometry& g, const std::vector<GeometryPart>& full, const model::Model& looks) {
    Profile profile;
    for (const GeometryPart& part : full)  // other vertices are those of levels, whose cards may reach further
        for (const std::uint32_t index : part.indices) profile.box.grow(dvec3(position_of(g.vertices[index])));
    if (profile.box.empty()) return profile;
    const dvec3 extent = profile.box.max - profile.box.min;
    if (!(extent.y > 0) || !(std::max(extent.x, extent.z) > 0)) return profile;
    double pixel_m = 0;
    for (std::size_t k = 0; k < profile_views; ++k) {
        const double azimuth = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(profile_views);
        FormPicture& picture = profile.plain[k];
        picture.clear(view_of(profile.box, direction_of(azimuth, 0), dvec3(0.0), profile_px), false);
        draw_geometry(looks, g.vertices, full, picture);
        pixel_m = std::max(pixel_m, std::ldexp(1.0, picture.view.exponent));
    }
    const double rows = std::min(std::floor(extent.y / pixel_m), max_rows);  // each has a line of each picture
    if (!(rows >= min_rows)) return profile;
    RowSums sums(profile.box.min.y, extent.y, static_cast<std::size_t>(rows));
    for (std::size_t k = 0; k < profile_views; ++k) sums.add(profile.plain[k], k);
    profile.rows = std::move(sums).finish(profile.plain);
    double straight = 0, diagonal = 0;
    for (const ProfileRow& row : profile.rows)
        for (std::size_t k = 0; k < profile_views; ++k) (k % 2 == 0 ? straight : diagonal) += row.width[k];
    if (!(straight + diagonal > 0)) profile.rows.clear();
    profile.square = diagonal > square_from * straight;
    return profile;
}

PrismStack stack_of(const Profile& profile, std::size_t rings, std::uint32_t sides) {
    const std::vector<ProfileRow>& rows = profile.rows;
    PrismStack stack;
    stack.square = profile.square;
    stack.sides = stack.square ? 4 : sides;
    const std::vector<std::size_t> at = bends(rows, rings);
    for (std::size_t i = 0; i < at.size(); ++i) {
        PrismRing ring;
        ring.height = i == 0 ? profile.box.min.y : i + 1 == at.size() ? profile.box.max.y : rows[at[i]].height;
        ring.centre = rows[at[i]].centre;
        ring.half = half_of(rows[at[i]], stack);
        ring.first_row = i == 0 ? 0 : (at[i - 1] + at[i] + 1) / 2;
        ring.end_row = i + 1 == at.size() ? rows.size() : (at[i] + at[i + 1] + 1) / 2;
        stack.rings.push_back(ring);
    }
    return stack;
}

Level emit_stack(Geometry& g, const PrismStack& stack, const Profile& profile, model::Index material, const dvec3& brightness) {
    GeometryPart part{material, {}};
    const auto base = static_cast<std::uint32_t>(g.vertices.size());
    const std::uint32_t n = stack.sides;
    add_vertices(g, stack, profile, brightness);
    const auto at = [&](std::size_t ring, std::uint32_t side) { return base + static_cast<std::uint32_t>(ring) * n + side % n; };
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        part.indices.insert(part.indices.end(), {a, b, c});
    };
    for (std::size_t i = 0; i + 1 < stack.rings.size(); ++i) {
        for (std::uint32_t s = 0; s < n; ++s) {
            add(at(i, s), at(i + 1, s), at(i + 1, s + 1));
            add(at(i, s), at(i + 1, s + 1), at(i, s + 1));
        }
    }
    const auto wide = [](const PrismRing& ring) { return ring.half.x + ring.half.y; };
    double widest = 0;
    for (const PrismRing& ring : stack.rings) widest = std::max(widest, wide(ring));
    const std::size_t top = stack.rings.size() - 1;
    for (std::uint32_t s = 1; s + 1 < n; ++s) {
        if (wide(stack.rings[0]) >= closed_from * widest) add(at(0, 0), at(0, s), at(0, s + 1));
        if (wide(stack.rings[top]) >= closed_from * widest) add(at(top, 0), at(top, s + 1), at(top, s));
    }
    Level level;
    level.triangles = static_cast<std::uint32_t>(part.indices.size() / 3);
    level.parts.push_back(std::move(part));
    return level;
}

}  // namespace surefoot::bake
