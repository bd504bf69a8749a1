// Engines without what belongs to walks alone.
#include "tools/accuracy/places.hpp"

#include <algorithm>
#include <thread>

#include "render/measure/calibrate.hpp"
#include "tools/walk/state.hpp"

namespace surefoot::accuracy {

Result<PlacesEngine> open_engine_of_places(const PlacesRequest& request, model::Model model, std::uint64_t model_hash,
                                           EngineOptions options) {
    const auto backend = gl::backend_named(request.backend);
    if (!backend) return backend.error();
    if (!(*backend)->draws())
        return Error{"--backend " + request.backend, "This backend draws no pictures to compare",
                     "Use one of: " + gl::drawing_backends(), ErrorKind::misuse};
    options.device.kind = (*backend)->kind;
    options.device.viewport = request.viewport();
    options.device.rasterisers = request.rasterisers;
    options.prepare.workers =
        request.workers > 0 ? request.workers : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    options.in_frame_check = false;
    options.hysteresis = 1;  // places are apart: none remembers another
    std::string note;
    const std::string state = walk::state_directory(request.state_dir);
    auto table = walk::load_costs(state, "", note);
    if (!table) return table.error();
    auto costs = walk::fitted_costs(state, *table, {model_hash, request.width, request.height, request.backend});
    if (!costs) return costs.error();
    auto engine = Engine::open(std::move(model), *costs, options);
    if (!engine) return engine.error();
    PlacesEngine out;
    out.engine = std::move(*engine);
    if (request.hour >= 0) out.engine->set_light(model::daylight_at(request.hour, out.engine->model().light));
    out.engine->set_time(request.time_s);
    out.machine = measure::machine_identity(out.engine->device().renderer(), request.rasterisers);
    out.uncalibrated = note;
    return out;
}

std::vector<Pose> poses_along(const Path& path, std::uint32_t count) {
    std::vector<Pose> poses;
    for (std::uint32_t i = 0; i < count; ++i) poses.push_back(sample_path(path, path.duration_s() * (i + 0.5) / count));
    return poses;
}

}  // namespace surefoot::accuracy
