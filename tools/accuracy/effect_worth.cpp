// Each effect switched off alone, then all of them, in turns with the whole picture.
#include "tools/accuracy/effect_worth.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "render/effects/effects.hpp"
#include "render/measure/flip.hpp"
#include "render/measure/image_metrics.hpp"
#include "render/model/walk_file.hpp"
#include "rt/base/statistics.hpp"
#include "rt/clock/clock.hpp"
#include "tools/report/page_parts.hpp"
#include "tools/report/report.hpp"
#include "tools/walk/path_source.hpp"

namespace surefoot::accuracy {

namespace {

constexpr int picture_quality = 85;

/// Draws places with and without some effects.
class Comparing {
public:
    Comparing(const PlacesRequest& request, const std::vector<Pose>& poses, const Progress& progress)
        : request_(request), poses_(poses), progress_(progress) {}

    /// Leaves `off` out. shown_at, if given, counts the places whose full detail has any of it.
    Result<WithAndWithout> without(model::EffectMask off, EffectReport& report, std::uint32_t* shown_at) {
        model::WalkFileInfo file;
        auto model = model::read_walk(request_.model_file, &file);
        if (!model) return model.error();
        EngineOptions options;
        options.device.switches = {off};
        auto opened = open_engine_of_places(request_, std::move(*model), file.hash, options);
        if (!opened) return opened.error();
        report.machine = opened->machine;
        report.uncalibrated = opened->uncalibrated;
        Engine& engine = *opened->engine;
        engine.device().bind();
        report.renderer = engine.device().renderer();
        auto found = at_all_places(engine, off, shown_at);
        engine.device().release();
        return found;
    }

private:
    Result<WithAndWithout> at_all_places(Engine& engine, model::EffectMask off, std::uint32_t* shown_at) {
        WithAndWithout out;
        double mse = 0, max_error = 0;
        const auto n = static_cast<double>(poses_.size());
        for (std::size_t p = 0; p < poses_.size(); ++p) {
            if (progress_.stopped())
                return Error{request_.model_file, "The report was stopped by the user", "", ErrorKind::stopped};
            const std::vector<gl::DrawItem> items = engine.full_detail(poses_[p]);
            const bool has = std::any_of(items.begin(), items.end(), [&](const gl::DrawItem& item) {
                return (engine.model().reps[item.rep].effects & off) != 0;
            });
            if (has && shown_at != nullptr) ++*shown_at;
            auto pictures = draw(engine, poses_[p], items, out);
            if (!pictures) return pictures.error();
            const auto& [with, bare] = *pictures;
            const double error = measure::snr(bare.rgba, with.rgba).mse;
            mse += error / n;
            if (error > 0) out.flip += measure::flip(bare.rgba, with.rgba, with.width, with.height) / n;
            if (!(error > max_error)) continue;
            max_error = error;
            out.max_at = static_cast<std::uint32_t>(p);
            out.with = report::jpeg_data_uri(with.rgba, with.width, with.height, picture_quality);
            out.without = report::jpeg_data_uri(bare.rgba, bare.width, bare.height, picture_quality);
        }
        out.psnr_db = report::psnr_db(mse);
        return out;
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
    model::EffectMask all = 0;
    for (const model::Material& material : model->materials) all |= material.effects;
    const std::vector<Pose> poses = poses_along(chosen->path, request.poses);
    Comparing comparing(request, poses, progress);
    const auto modules = effects::all_effects();
    for (std::size_t e = 0; e < modules.size(); ++e) {
        EffectWorth effect;
        effect.name = modules[e].name;
        effect.help = modules[e].help;
        effect.requested_by = modules[e].requested_by;
        for (const model::EffectFinding& f : model->effects) {
            if (f.bit != modules[e].bit) continue;
            effect.called_for = f.called_for;
            effect.reason = f.reason;
            effect.triangles = f.triangles;
        }
        progress.update(effect.name, static_cast<double>(e) / static_cast<double>(modules.size() + 1));
        if ((all & modules[e].bit) != 0) {
            auto worth = comparing.without(modules[e].bit, report, &effect.shown_at);
            if (!worth) return worth.error();
            if (effect.shown_at > 0) effect.worth = std::move(*worth);
        }
        report.effects.push_back(std::move(effect));
    }
    progress.update("bare", static_cast<double>(modules.size()) / static_cast<double>(modules.size() + 1));
    auto bare = comparing.without(all, report, nullptr);
    if (!bare) return bare.error();
    report.bare = std::move(*bare);
    return report;
}

}  // namespace surefoot::accuracy
