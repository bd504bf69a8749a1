// Counts what levels cover in the pictures by which losses are measured, and grows what is small (level_coverage.hpp).
#include "render/bake/level_coverage.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "render/bake/cards.hpp"
#include "render/bake/mesh_surface.hpp"
#include "render/bake/picture_loss.hpp"
#include "render/measure/mesh_distance.hpp"

namespace surefoot::bake {

namespace {

constexpr std::uint32_t covered_px = 64;
constexpr double wanted_cover = 0.8;    // of full detail, when a level grows
constexpr double max_growth = 2.5;      // of a part's length: as of cards in clusters
constexpr float max_grown_loss = 1.1F;  // of what the level lost before it grew

/// Of colours that are not known yet: those of a usual model.
constexpr model::ColourSpread presumed_colours{{0.4F, 0.4F, 0.4F}, 0.05F};

/// What full detail covers, beside what levels do.
class Covered {
public:
    Covered(const Geometry& g, const std::vector<GeometryPart>& full, const Box& box, const model::Model& looks)
        : g_(g), looks_(looks) {
        for (const auto& [azimuth_rad, elevation_rad] : loss_directions)
            full_.push_back(draw(full, view_of(box, direction_of(azimuth_rad, elevation_rad), dvec3(0.0), covered_px)));
    }
    /// A level's samples to full detail's, and what it loses.
    struct Share {
        double covered = 1;
        float loss = 0;
        [[nodiscard]] bool poor() const { return covered < min_covered || covered > max_covered; }
    };
    [[nodiscard]] Share of(const Level& level) const {
        PictureDifference difference;
        for (const FormPicture& full : full_) difference.add(full, draw(level.parts, full.view));
        return {difference.covered(), difference.loss(presumed_colours).colour[1]};
    }

private:
    [[nodiscard]] FormPicture draw(const std::vector<GeometryPart>& parts, const FormView& view) const {
        FormPicture picture;
        picture.clear(view);
        draw_geometry(looks_, g_.vertices, parts, picture);
        return picture;
    }
    const Geometry& g_;
    const model::Model& looks_;
    std::vector<FormPicture> full_;
};

/// Its connected parts are `scale` times as long, within the box. Appends vertices.
Level grown_level(Geometry& g, const Level& level, double scale, const Box& box) {
    Level out;
    const std::size_t before = g.vertices.size();
    for (const GeometryPart& part : level.parts) {
        const Cards connected = cards_of(g, part);
        GeometryPart grown{part.material, {}};
        for (const auto& one : connected) grown.indices.insert(grown.indices.end(), one.begin(), one.end());
        enlarge_cards(g, grown, connected, scale * scale * area_of(g, grown.indices), scale);
        out.triangles += static_cast<std::uint32_t>(grown.indices.size() / 3);
        out.parts.push_back(std::move(grown));
    }
    for (std::size_t v = before; v < g.vertices.size(); ++v) {
        const dvec3 at = glm::clamp(dvec3(position_of(g.vertices[v])), box.min, box.max);
        for (int k = 0; k < 3; ++k) g.vertices[v].position[k] = static_cast<float>(at[k]);
    }
    return out;
}

/// Nothing: no growth within reason makes it cover enough, or it looks worse then.
std::optional<Level> grow_to_cover(Geometry& g, const Level& level, const Covered& covered, Covered::Share share,
                                   const Box& box) {
    const float loss = share.loss;
    const std::size_t before = g.vertices.size();
    double scale = 1;
    for (int attempt = 0; attempt < 3 && share.covered > 0; ++attempt) {
        scale = std::min(max_growth, scale * std::sqrt(wanted_cover / share.covered));
        Level grown = grown_level(g, level, scale, box);
        share = covered.of(grown);
        if (!share.poor() && share.loss <= max_grown_loss * loss) return grown;
        g.vertices.resize(before);
        g.baked.resize(before);
        if (scale >= max_growth || share.covered >= min_covered) break;
    }
    return {};
}

}  // namespace

std::vector<Level> take_poor_levels(LodChain& chain, const ChainOptions& options) {
    std::vector<Level> poor;
    if (options.looks == nullptr || chain.levels.size() < 2) return poor;
    Geometry& g = chain.full;
    const Level& full = chain.levels.back();
    Box box;
    for (const GeometryPart& part : full.parts)  // other vertices are those of levels
        for (const std::uint32_t index : part.indices) box.grow(dvec3(position_of(g.vertices[index])));
    const Covered covered(g, full.parts, box, *options.looks);
    measure::DistanceLimits limits;
    limits.relative = options.slack;
    limits.absolute = static_cast<float>(0.0005 * box.diagonal());
    std::vector<Level> kept;
    for (std::size_t i = 0; i + 1 < chain.levels.size(); ++i) {
        Level& level = chain.levels[i];
        const Covered::Share share = covered.of(level);
        if (!share.poor()) {
            kept.push_back(std::move(level));
            continue;
        }
        auto grown = share.covered < min_covered ? grow_to_cover(g, level, covered, share, box) : std::nullopt;
        if (!grown) {
            poor.push_back(std::move(level));
            continue;
        }
        const MeshSurface surface(g.vertices, full.parts), coarse(g.vertices, grown->parts);
        grown->error_m = std::max(level.error_m, measure::two_sided_distance(surface.view(), coarse.view(), limits).upper);
        kept.push_back(std::move(*grown));
    }
    kept.push_back(std::move(chain.levels.back()));
    chain.levels = std::move(kept);
    raise_errors(chain.levels);
    return poor;
}

void put_back_poor_level(LodChain& chain, std::vector<Level>&& poor) {
    if (poor.empty() || chain.levels.size() > 1) return;
    chain.levels.insert(chain.levels.begin(), std::move(poor.back()));
}

}  // namespace surefoot::bake
