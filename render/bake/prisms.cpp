// Judging stacks of prisms beside the levels of a chain, by pictures (prisms.hpp).
#include "render/bake/prisms.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

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
    /// Of the samples that either covers, what share both cover: the mean of all views, whose pixels differ in size.
    [[nodiscard]] double common(const Level& level) const {
        double sum = 0, views = 0;
        for (const std::vector<FormPicture>* of : {&round_, &above_}) {
            for (const FormPicture& full : *of) {
                const FormPicture own = draw(level, full.view);
                double both = 0, either = 0;
                for (std::size_t i = 0; i < own.samples.size(); ++i) {
                    both += own.samples[i].covered() && full.samples[i].covered() ? 1 : 0;
                    either += own.samples[i].covered() || full.samples[i].covered() ? 1 : 0;
                }
                if (!(either > 0)) continue;
                sum += both / either;
                views += 1;
            }
        }
        return views > 0 ? sum / views : 0;
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

/// A stack that covers as much as full detail and is as bright, from all round.
struct FittedStack {
    PrismStack stack;
    dvec3 brightness{1.0};
    std::uint32_t triangles = 0;
    float loss = 0;
};

/// What a stack looks like, without leaving its vertices in the geometry.
template <class Use>
auto while_emitted(Geometry& g, const FittedStack& fitted, const Profile& profile, model::Index material, const Use& use) {
    const std::size_t vertices = g.vertices.size();
    const auto seen = use(emit_stack(g, fitted.stack, profile, material, fitted.brightness));
    g.vertices.resize(vertices);
    g.baked.resize(vertices);
    return seen;
}

/// Nothing: it would not show, or its outline is another one.
std::optional<FittedStack> fit_stack(Geometry& g, const PrismStack& stack, const Profile& profile, const Judge& judge,
                                     model::Index material) {
    FittedStack fitted{stack};
    const Judge::Seen wanted = judge.seen(nullptr);
    const Judge::Seen got = while_emitted(g, fitted, profile, material, [&](const Level& level) { return judge.seen(&level); });
    if (!(wanted.samples > 0) || !(got.samples > 0)) return {};
    for (PrismRing& ring : fitted.stack.rings) ring.half *= std::clamp(wanted.samples / got.samples, 0.5, 2.0);
    fitted.brightness = glm::clamp(wanted.colour / glm::max(got.colour, dvec3(1.0)), dvec3(0.4), dvec3(1.6));
    const double common = while_emitted(g, fitted, profile, material, [&](const Level& level) {
        fitted.triangles = level.triangles;
        fitted.loss = judge.loss(level);
        return judge.common(level);
    });
    if (common < min_common) return {};
    return fitted;
}

/// Stacks that each lose a tenth less than all levels and stacks of as many triangles or fewer; small ones first.
std::vector<FittedStack> useful_stacks(LodChain& chain, const std::vector<float>& losses, const Profile& profile,
                                       const Judge& judge, model::Index material) {
    struct Size {
        std::size_t rings;
        std::uint32_t sides;
    };
    std::vector<FittedStack> stacks;
    for (const Size size : {Size{3, 5}, Size{5, 5}}) {
        const auto fitted = fit_stack(chain.full, stack_of(profile, size.rings, size.sides), profile, judge, material);
        if (!fitted) continue;
        bool useful =
            stacks.empty() || (fitted->triangles > stacks.back().triangles && fitted->loss < clearly * stacks.back().loss);
        for (std::size_t i = 0; i < losses.size(); ++i)
            useful = useful && (chain.levels[i].triangles > fitted->triangles || fitted->loss < clearly * losses[i]);
        if (useful) stacks.push_back(*fitted);
    }
    return stacks;
}

/// Whether one of the stacks looks no worse than a level and takes about as long, or less.
bool replaced(const Level& level, float loss, const std::vector<FittedStack>& stacks) {
    return level.triangles <= max_rival_triangles && std::ranges::any_of(stacks, [&](const FittedStack& stack) {
               return stack.loss <= loss &&
                      level.triangles + triangles_a_draw >= alike_time * (stack.triangles + triangles_a_draw);
           });
}

}  // namespace

void add_prisms(LodChain& chain, const ChainOptions& options) {
    if (options.looks == nullptr || options.proxy_material == model::none) return;
    if (chain.levels.back().triangles < min_full_triangles) return;
    Geometry& g = chain.full;
    const Level full = chain.levels.back();
    const Profile profile = profile_of(g, full.parts, *options.looks);
    if (profile.rows.empty()) return;
    const Judge judge(g, full, profile.box, *options.looks);
    std::vector<float> losses;
    for (const Level& level : chain.levels)
        losses.push_back(level.triangles <= max_rival_triangles && level.error_m > 0 ? judge.loss(level) : 0.0F);
    const std::vector<FittedStack> stacks = useful_stacks(chain, losses, profile, judge, options.proxy_material);
    if (stacks.empty()) return;
    std::vector<Level> levels;
    for (std::size_t i = 0; i + 1 < chain.levels.size(); ++i)
        if (!replaced(chain.levels[i], losses[i], stacks)) levels.push_back(std::move(chain.levels[i]));
    const double diagonal_m = profile.box.diagonal();
    const MeshSurface surface(g.vertices, full.parts);
    measure::DistanceLimits limits;
    limits.relative = options.slack;
    limits.absolute = static_cast<float>(0.0005 * diagonal_m);
    for (const FittedStack& stack : stacks) {
        Level level = emit_stack(g, stack.stack, profile, options.proxy_material, stack.brightness);
        const MeshSurface coarse(g.vertices, level.parts);
        level.error_m = std::max(measure::two_sided_distance(surface.view(), coarse.view(), limits).upper,
                                 static_cast<float>(min_proxy_error * diagonal_m));
        levels.push_back(std::move(level));
    }
    std::ranges::sort(levels, {}, &Level::triangles);
    levels.push_back(full);
    chain.levels = std::move(levels);
    raise_errors(chain.levels);
}

}  // namespace surefoot::bake
