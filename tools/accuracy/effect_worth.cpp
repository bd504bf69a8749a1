// How often each effect is in use, then each switched off alone, in turns with the whole picture.
#include "tools/accuracy/effect_worth.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include <fmt/format.h>

#include "render/effects/effects.hpp"
#include "render/model/room_sides.hpp"
#include "render/model/walk_file.hpp"
#include "rt/base/statistics.hpp"
#include "rt/clock/clock.hpp"
#include "tools/walk/path_source.hpp"

namespace surefoot::accuracy {

namespace {

/// Draws places with and without some effects.
class Comparing {
public:
    Comparing(const PlacesRequest& request, const std::vector<Pose>& poses, const Progress& progress)
        : request_(request), poses_(poses), progress_(progress) {}

    /// Leaves `off` out. shown_at counts the places whose full detail has any of it.
    Result<WithAndWithout> without(model::EffectMask off, std::uint32_t& shown_at) {
        model::WalkFileInfo file;
        auto model = model::read_walk(request_.model_file, &file);
        if (!model) return model.error();
        EngineOptions options;
        options.device.switches = {off};
        auto opened = open_engine_of_places(request_, std::move(*model), file.hash, options);
        if (!opened) return opened.error();
        Engine& engine = *opened->engine;
        engine.device().bind();
        auto found = at_all_places(engine, off, shown_at);
        engine.device().release();
        return found;
    }

private:
    Result<WithAndWithout> at_all_places(Engine& engine, model::EffectMask off, std::uint32_t& shown_at) {
        WithAndWithout out;
        DifferenceSum difference;
        for (const Pose& pose : poses_) {
            if (progress_.stopped())
                return Error{request_.model_file, "The report was stopped by the user", "", ErrorKind::stopped};
            const std::vector<gl::DrawItem> items = engine.full_detail(pose);
            const bool has = std::any_of(items.begin(), items.end(), [&](const gl::DrawItem& item) {
                return (engine.model().reps[item.rep].effects & off) != 0;
            });
            if (has || (off & model::background_effects) != 0) ++shown_at;
            auto pictures = draw(engine, pose, items, out);
            if (!pictures) return pictures.error();
            difference.add(pictures->first, pictures->second);
        }
        return WithAndWithout{difference.found(), out.with_ms, out.without_ms};
    }

    /// Timed in turns, so that a busy moment of the machine strikes both; then a picture of each.
    Result<std::pair<gl::PixelImage, gl::PixelImage>> draw(Engine& engine, const Pose& pose,
                                                           const std::vector<gl::DrawItem>& items, WithAndWithout& out) const {
        std::array<std::vector<double>, 2> ms;
        std::array<gl::PixelImage, 2> images;
        engine.device().draws.plays();
        for (int round = -1; round < std::max(1, request_.repeats); ++round) {
            for (const bool off : {false, true}) {
                engine.hide_effects(off ? ~model::EffectMask{0} : 0);
                const std::int64_t begun = rt::monotonic_ns();
                engine.refresh_shadow(pose);
                engine.draw_unbudgeted(pose, items);
                if (round >= 0) {
                    ms[off ? 1 : 0].push_back(static_cast<double>(rt::monotonic_ns() - begun) * 1e-6);
                    continue;
                }
                auto image = engine.device().read_pixels();  // the first draw of a place warms up
                if (!image) return image.error();
                images[off ? 1 : 0] = std::move(*image);
            }
        }
        engine.hide_effects(0);
        const auto n = static_cast<double>(poses_.size());
        out.with_ms += quantile_of(ms[0], 0.5) / n;
        out.without_ms += quantile_of(ms[1], 0.5) / n;
        return std::pair(std::move(images[0]), std::move(images[1]));
    }

    const PlacesRequest& request_;
    const std::vector<Pose>& poses_;
    const Progress& progress_;
};

/// Why items along the path have an effect, or why none has.
std::string along_path(const model::Model& m, const UseOfEffects& use, std::size_t bit, bool called_for) {
    const FramesInUse& walked = use.walked;
    if (walked.frames == 0) return {};
    if (called_for && (1U << bit & model::background_effects) != 0)
        return "It is drawn behind everything in every frame, and no item has it.";
    if (walked.frames_with[bit] == 0)
        return fmt::format(
            "No item has it in {} of {} frames: {}.", walked.frames, walked.frames,
            called_for ? "what has it is not in view, hidden, or in no form that was chosen" : "the model does not call for it");
    const model::Index rep = walked.first_rep[bit], node = node_of(m, rep);
    std::uint64_t with = 0;
    for (model::Index p = m.reps[rep].first_part; p < m.reps[rep].first_part + m.reps[rep].part_count; ++p)
        if ((m.materials[m.parts[p].material].effects >> bit & 1U) != 0) with += m.parts[p].index_count / 3;
    std::string name = node == model::none ? "" : m.name_of(m.nodes[node]);
    if (name.empty()) name = "no name";
    return fmt::format(
        "{} of {} frames have no item with it. The first that has one is frame {}: node {} ({}) is in view there, and "
        "{} of its {} triangles have it.",
        walked.frames - walked.frames_with[bit], walked.frames, walked.first_frame[bit], node, name, with, m.reps[rep].triangles);
}

/// Which items those are, where they stand, and whether they see sky where it matters.
std::string items_in_words(const std::vector<DrawnHolder>& drawn, model::EffectMask bit) {
    std::string out;
    for (std::size_t i = 0; i < std::min(drawn.size(), max_holders); ++i) {
        const DrawnHolder& d = drawn[i];
        out += fmt::format("{}{} ({} items; node {} near {:.1f} {:.1f} {:.1f}", i == 0 ? " Most are of " : ", ",
                           d.name.empty() ? "no name" : d.name, d.items, d.node, d.middle_m.x, d.middle_m.y, d.middle_m.z);
        if ((bit & model::effects_under_sky) != 0) out += fmt::format(", {} of {} vertices see sky", d.see_sky, d.vertices);
        out += ")";
    }
    return out.empty() ? out : out + ".";
}

/// What the bake found, and what the path has of it.
EffectWorth found_effect(const effects::EffectModule& module, std::size_t bit, const model::Model& model,
                         const UseOfEffects& use) {
    EffectWorth effect;
    effect.name = module.name;
    effect.help = module.help;
    effect.requested_by = module.requested_by;
    for (const model::EffectFinding& f : model.effects) {
        if (f.bit != module.bit) continue;
        effect.called_for = f.called_for;
        effect.reason = f.reason;
        effect.triangles = f.triangles;
    }
    effect.frames_share = use.full.share_of_frames(bit);
    effect.triangles_share = use.full.share_of_triangles(bit);
    effect.walked_frames_share = use.walked.share_of_frames(bit);
    effect.walked_triangles_share = use.walked.share_of_triangles(bit);
    effect.where = holders_of(model, bit);
    effect.walked_frames = use.walked.frames_with[bit];
    effect.walked_items = use.walked.items_with[bit];
    effect.drawn = drawn_holders(model, use.walked, bit);
    effect.along_path = along_path(model, use, bit, effect.called_for) + items_in_words(effect.drawn, module.bit);
    effect.behind = effect.called_for && (module.bit & model::background_effects) != 0;
    if (effect.behind) {
        effect.frames_share = effect.walked_frames_share = 1;
        effect.walked_frames = use.walked.frames;
    }
    return effect;
}

/// How often effects are in use, and the three ways: all that one engine as called for can measure.
Result<UseOfEffects> measure_whole(const PlacesRequest& request, const Path& path, const std::vector<Pose>& poses,
                                   const Progress& progress, EffectReport& report) {
    auto opened = open_as_called_for(request);
    if (!opened) return opened.error();
    report.machine = opened->machine;
    report.uncalibrated = opened->uncalibrated;
    Engine& engine = *opened->engine;
    engine.device().bind();
    report.renderer = engine.device().renderer();
    report.use_frames = std::max(min_use_poses, request.poses);
    const UseOfEffects use = measure_use(engine, poses_along(path, report.use_frames), progress, request.time_s);
    engine.device().release();
    progress.update("all on", 0.1);
    auto ways = measure_ways(engine, request, poses, progress);
    if (!ways) return ways.error();
    report.ways = std::move(*ways);
    report.bare = {report.ways.bare.difference, report.ways.as_called_for.ms, report.ways.bare.ms};
    return use;
}

}  // namespace

Result<EffectReport> measure_effects(const PlacesRequest& request, const Progress& progress) {
    EffectReport report;
    auto model = model::read_walk(request.model_file);
    if (!model) return model.error();
    auto chosen = walk::choose_path(request.path_file, request.model_file, *model, request.lift_m);
    if (!chosen) return chosen.error();
    report.model = request.model_file;
    report.path = chosen->source;
    report.width = request.width;
    report.height = request.height;
    report.poses = request.poses;
    report.hour = request.hour;
    report.time_s = request.time_s;
    report.regions = regions_of(*model);
    const std::vector<Pose> poses = poses_along(chosen->path, request.poses);
    progress.update("frames in use", 0);
    auto use = measure_whole(request, chosen->path, poses, progress, report);
    if (!use) return use.error();
    Comparing comparing(request, poses, progress);
    const model::EffectMask all = effects_of_pictures(*model);
    const auto modules = effects::all_effects();
    for (std::size_t e = 0; e < modules.size(); ++e) {
        EffectWorth effect =
            found_effect(modules[e], static_cast<std::size_t>(std::countr_zero(modules[e].bit + 0U)), *model, *use);
        const auto done = static_cast<double>(e + 1), steps = static_cast<double>(modules.size() + 1);
        progress.update(effect.name, done / steps);
        if ((all & modules[e].bit) != 0) {
            auto worth = comparing.without(modules[e].bit, effect.shown_at);
            if (!worth) return worth.error();
            if (effect.shown_at > 0) effect.worth = std::move(*worth);
        }
        report.effects.push_back(std::move(effect));
    }
    return report;
}

}  // namespace surefoot::accuracy
