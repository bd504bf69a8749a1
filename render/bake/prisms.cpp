// Judging stacks of prisms beside the levels of a chain, by pictures (prisms.hpp).
#include "render/bake/prisms.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <span>

#include "render/bake/mesh_surface.hpp"
#include "render/bake/picture_loss.hpp"
#include "render/bake/prism_stack.hpp"
#include "render/measure/mesh_distance.hpp"

namespace surefoot::bake {

namespace {

constexpr std::uint32_t judged_px = 64;
constexpr std::uint32_t min_full_triangles = 40;    // fewer are drawn as they are
constexpr std::uint32_t max_rival_triangles = 160;  // of levels that a stack is compared with
constexpr float clearly = 0.9F;                     // of the loss of levels that are as cheap, as boxes
/// Of the samples that the stack or full detail covers, both have to cover so many. What stands apart in one object (two
/// rails) would become one beam between them.
constexpr double min_common = 0.3;
/// Levels of this share of its time or more, which look no better, have no use beside a stack. A draw takes as long as so many
/// triangles.
constexpr double alike_time = 0.65, triangles_a_draw = 40;
/// What shows where a level shows nothing is not known yet: colours of a usual model.
constexpr model::ColourSpread usual_colours{{0.4F, 0.4F, 0.4F}, 0.05F};

/// How levels look beside full detail.
class Judge {
public:
    Judge(const Geometry& g, const Level& full, const Box& box, const model::Model& looks) : g_(g), looks_(looks) {
        const auto see = [&](unsigned eighth, double elevation) {
            return draw(full, view_of(box, direction_of(std::numbers::pi * eighth / 4, elevation), dvec3(0.0), judged_px));
        };
        for (unsigned k = 0; k < 8; ++k) round_.push_back(see(k, 0.0));
        for (unsigned k = 1; k < 8; k += 2) above_.push_back(see(k, 0.6));
        above_.push_back(see(0, std::numbers::pi / 2));
    }
    [[nodiscard]] float loss(const Level& level) const {
        PictureDifference difference;
        for (std::size_t k = 0; k < round_.size(); k += 2) difference.add(round_[k], draw(level, round_[k].view));
        for (const FormPicture& full : above_) difference.add(full, draw(level, full.view));
        return difference.loss(usual_colours).colour[1];
    }
    /// Of the samples that either covers, what share both cover.
    [[nodiscard]] double common(const Level& level) const {
        double both = 0, either = 0;
        for (const std::vector<FormPicture>* views : {&round_, &above_}) {
            for (const FormPicture& full : *views) {
                const FormPicture own = draw(level, full.view);
                for (std::size_t i = 0; i < own.samples.size(); ++i) {
                    both += own.samples[i].covered() && full.samples[i].covered() ? 1 : 0;
                    either += own.samples[i].covered() || full.samples[i].covered() ? 1 : 0;
                }
            }
        }
        return either > 0 ? both / either : 0;
    }
    /// What horizontal views show: how many samples, and their mean colour.
    struct Seen {
        double samples = 0;
        dvec3 colour{0.0};
    };
    [[nodiscard]] Seen seen(const Level* level) const {  // none: full detail
        Seen out;
        for (const FormPicture& full : round_) {
            const FormPicture own = level != nullptr ? draw(*level, full.view) : FormPicture();
            for (const FormSample& sample : level != nullptr ? own.samples : full.samples) {
                if (!sample.covered()) continue;
                out.samples += 1;
                out.colour += dvec3(sample.rgb[1][0], sample.rgb[1][1], sample.rgb[1][2]);
            }
        }
        out.colour /= std::max(out.samples, 1.0);
        return out;
    }

private:
    [[nodiscard]] FormPicture draw(const Level& level, const FormView& view) const {
        FormPicture picture;
        picture.clear(view);
        draw_geometry(looks_, g_.vertices, level.parts, picture);
        return picture;
    }
    const Geometry& g_;
    const model::Model& looks_;
    std::vector<FormPicture> round_, above_;  // of full detail
};

/// A stack that covers as much as full detail and is as bright, from all round. Nothing: it would not show.
std::optional<Level> fitted_stack(Geometry& g, PrismStack stack, const Profile& profile, const Judge& judge,
                                  model::Index material) {
    const std::size_t vertices = g.vertices.size();
    const Level first = emit_stack(g, stack, profile, material, dvec3(1.0));
    const Judge::Seen wanted = judge.seen(nullptr), got = judge.seen(&first);
    g.vertices.resize(vertices);
    g.baked.resize(vertices);
    if (!(wanted.samples > 0) || !(got.samples > 0)) return {};
    for (PrismRing& ring : stack.rings) ring.half *= std::clamp(wanted.samples / got.samples, 0.5, 2.0);
    const dvec3 brightness = glm::clamp(wanted.colour / glm::max(got.colour, dvec3(1.0)), dvec3(0.4), dvec3(1.6));
    return emit_stack(g, stack, profile, material, brightness);
}

/// The levels of a chain with their losses; full detail has none.
struct JudgedLevels {
    std::vector<Level>& levels;
    std::vector<float> losses;

    JudgedLevels(std::vector<Level>& of, const Judge& judge) : levels(of) {
        for (const Level& level : levels) losses.push_back(is_rival(level) ? judge.loss(level) : 0.0F);
    }
    static bool is_rival(const Level& level) { return level.triangles <= max_rival_triangles; }
    [[nodiscard]] bool has_use_for(const Level& stack, float loss) const {
        for (std::size_t i = 0; i < levels.size(); ++i)
            if (levels[i].triangles <= stack.triangles && clearly * losses[i] <= loss) return false;
        return true;
    }
    void insert(Level&& stack, float loss) {
        for (std::size_t i = levels.size() - 1; i-- > 0;) {
            const double time = (levels[i].triangles + triangles_a_draw) / (stack.triangles + triangles_a_draw);
            if (!is_rival(levels[i]) || time < alike_time || losses[i] < loss) continue;
            levels.erase(levels.begin() + static_cast<std::ptrdiff_t>(i));
            losses.erase(losses.begin() + static_cast<std::ptrdiff_t>(i));
        }
        const auto place =
            std::find_if(levels.begin(), levels.end() - 1, [&](const Level& l) { return l.triangles > stack.triangles; });
        losses.insert(losses.begin() + (place - levels.begin()), loss);
        levels.insert(place, std::move(stack));
    }
};

/// From fine to coarse, errors rise.
void raise_errors(std::vector<Level>& levels) {
    float above_m = levels.back().error_m;
    for (std::size_t i = levels.size() - 1; i-- > 0;) {
        above_m = std::nextafter(above_m, std::numeric_limits<float>::infinity());
        levels[i].error_m = above_m = std::max(levels[i].error_m, above_m);
    }
}

}  // namespace

void add_prisms(LodChain& chain, const ChainOptions& options) {
    Geometry& g = chain.full;
    if (options.looks == nullptr || options.proxy_material == model::none) return;
    if (chain.levels.back().triangles < min_full_triangles) return;
    const std::vector<GeometryPart> full = chain.levels.back().parts;
    const Profile profile = profile_of(g, full, *options.looks);
    if (profile.rows.empty()) return;
    const double diagonal_m = profile.box.diagonal();
    const Judge judge(g, chain.levels.back(), profile.box, *options.looks);
    JudgedLevels judged(chain.levels, judge);
    const MeshSurface surface(g.vertices, full);
    measure::DistanceLimits limits;
    limits.relative = options.slack;
    limits.absolute = static_cast<float>(0.0005 * diagonal_m);
    struct Size {
        std::size_t rings;
        std::uint32_t sides;
    };
    for (const Size size : {Size{3, 5}, Size{5, 5}}) {
        const std::size_t vertices = g.vertices.size();
        std::optional<Level> stack =
            fitted_stack(g, stack_of(profile, size.rings, size.sides), profile, judge, options.proxy_material);
        const float loss = stack ? judge.loss(*stack) : 0.0F;
        if (!stack || !judged.has_use_for(*stack, loss) || judge.common(*stack) < min_common) {
            g.vertices.resize(vertices);
            g.baked.resize(vertices);
            continue;
        }
        const MeshSurface coarse(g.vertices, stack->parts);
        stack->error_m = std::max(measure::two_sided_distance(surface.view(), coarse.view(), limits).upper,
                                  static_cast<float>(min_proxy_error * diagonal_m));
        judged.insert(std::move(*stack), loss);
    }
    raise_errors(chain.levels);
}

}  // namespace surefoot::bake
