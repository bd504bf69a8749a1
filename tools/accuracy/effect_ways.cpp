// Two engines side by side, timed in turns.
#include "tools/accuracy/effect_ways.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <vector>

#include "render/model/walk_file.hpp"
#include "rt/base/statistics.hpp"
#include "rt/clock/clock.hpp"

namespace surefoot::accuracy {

namespace {

/// A way while it is measured.
struct Drawn {
    Engine* engine;
    bool effects;  ///< shows the switchable ones
    Way* way;
    std::vector<double> ms{};  ///< of this place
    gl::PixelImage image{};    ///< of this place
};

double draw_ms(const Drawn& drawn, const Pose& pose, const std::vector<gl::DrawItem>& items) {
    drawn.engine->hide_effects(drawn.effects ? 0 : ~model::EffectMask{0});
    const std::int64_t begun = rt::monotonic_ns();
    drawn.engine->refresh_shadow(pose);
    drawn.engine->draw_unbudgeted(pose, items);
    return static_cast<double>(rt::monotonic_ns() - begun) * 1e-6;
}

/// The ways of one engine, on its context. An untimed draw comes first: it pays for the change of contexts.
Result<void> take_turn(std::span<Drawn> ways, const Pose& pose, const std::vector<gl::DrawItem>& items, bool first) {
    gl::Device& device = ways.front().engine->device();
    device.bind();
    for (Drawn& drawn : ways) {
        if (first || &drawn == &ways.front()) draw_ms(drawn, pose, items);
        if (!first) continue;
        const gl::FrameStats stats = device.stats();
        drawn.way->batches += stats.batches;
        drawn.way->state_changes += stats.state_changes;
        drawn.way->draws += stats.draws;
        auto image = device.read_pixels();
        if (!image) {
            device.release();
            return image.error();
        }
        drawn.image = std::move(*image);
    }
    if (!first)
        for (Drawn& drawn : ways) drawn.ms.push_back(draw_ms(drawn, pose, items));
    ways.front().engine->hide_effects(0);
    device.release();
    return {};
}

}  // namespace

model::EffectMask effects_of_materials(const model::Model& model) {
    model::EffectMask all = 0;
    for (const model::Material& material : model.materials) all |= material.effects;
    return all;
}

model::EffectMask effects_of_pictures(const model::Model& model) {
    return effects_of_materials(model) | (model.called_for() & model::background_effects);
}

Result<PlacesEngine> open_as_called_for(const PlacesRequest& request) {
    model::WalkFileInfo file;
    auto model = model::read_walk(request.model_file, &file);
    if (!model) return model.error();
    EngineOptions options;
    options.device.switches = {effects_of_pictures(*model)};
    return open_engine_of_places(request, std::move(*model), file.hash, options);
}

Result<ThreeWays> measure_ways(Engine& as_called_for, const PlacesRequest& request, std::span<const Pose> poses,
                               const Progress& progress) {
    ThreeWays out;
    model::WalkFileInfo file;
    auto model = model::read_walk(request.model_file, &file);
    if (!model) return model.error();
    const auto behind = static_cast<std::uint32_t>(std::popcount(model->called_for() & model::background_effects));
    out.as_called_for.programs = programs_of(*model) + behind;
    out.bare.programs = programs_of(*model, effects_of_materials(*model));
    out.spread = turn_all_on(*model);
    out.all_on.programs = programs_of(*model) + behind;
    auto opened = open_engine_of_places(request, std::move(*model), file.hash, {});
    if (!opened) return opened.error();
    opened->engine->device().bind();
    opened->engine->device().release();

    std::array<Drawn, 3> ways{Drawn{&as_called_for, true, &out.as_called_for}, Drawn{&as_called_for, false, &out.bare},
                              Drawn{opened->engine.get(), true, &out.all_on}};
    std::array<DifferenceSum, 3> differences;
    const auto n = static_cast<double>(poses.size());
    for (const Pose& pose : poses) {
        if (progress.stopped()) return Error{request.model_file, "The report was stopped by the user", "", ErrorKind::stopped};
        const std::vector<gl::DrawItem> items = as_called_for.full_detail(pose);
        for (int round = -1; round < std::max(1, request.repeats); ++round) {
            for (const std::span<Drawn> turn : {std::span(ways).first(2), std::span(ways).last(1)})
                if (auto ok = take_turn(turn, pose, items, round < 0); !ok) return ok.error();
        }
        for (std::size_t w = 0; w < ways.size(); ++w) {
            ways[w].way->ms += quantile_of(ways[w].ms, 0.5) / n;
            ways[w].ms.clear();
            differences[w].add(ways[0].image, ways[w].image);
        }
    }
    for (std::size_t w = 0; w < ways.size(); ++w) {
        Way& way = *ways[w].way;
        way.difference = differences[w].found();
        for (double* sum : {&way.batches, &way.state_changes, &way.draws}) *sum /= n;
    }
    return out;
}

}  // namespace surefoot::accuracy
