// A walk's outputs, checked before it begins.
#include "tools/walk/walk_results.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <system_error>
#include <vector>

#include "render/gl/backends.hpp"
#include "rt/base/file.hpp"
#include "tools/walk/state.hpp"

namespace surefoot::walk {

namespace {

struct Output {
    std::string option, file;
    bool in_folder = false;  ///< of a folder that is made where it is missing
};

std::vector<Output> outputs_of(const WalkRequest& r) {
    std::vector<Output> outputs;
    const auto add = [&](const char* option, const std::string& place, std::initializer_list<const char*> names) {
        if (place.empty()) return;
        if (names.size() == 0) outputs.push_back({option, place, false});
        for (const char* name : names) outputs.push_back({option, (std::filesystem::path(place) / name).string(), true});
    };
    add("--ledger", r.ledger_file, {});
    add("--trace", r.trace_file, {});
    add("--capture", r.capture_file, {});
    add("--snap", r.snap_dir, {"00000.png"});
    add("--report", r.report_dir, {"index.html", "ledger.csv", "walk.json"});
    return outputs;
}

bool same_file(const std::string& a, const std::string& b) {
    std::error_code failed;
    if (std::filesystem::equivalent(a, b, failed)) return true;
    const auto x = std::filesystem::weakly_canonical(std::filesystem::absolute(a), failed);
    const auto y = std::filesystem::weakly_canonical(std::filesystem::absolute(b), failed);
    return !failed && x == y;
}

}  // namespace

Result<void> check_outputs(const WalkRequest& request) {
    const auto backend = gl::backend_named(request.backend);
    if (!backend) return backend.error();
    if (!request.snap_dir.empty() && !(*backend)->draws()) {
        return Error{"--snap " + request.snap_dir, fmt::format("The {} backend draws no pictures", request.backend),
                     fmt::format("Remove --snap or --backend {}", request.backend), ErrorKind::misuse};
    }
    if (request.pictures > 0 && !(*backend)->draws()) {
        return Error{fmt::format("--pictures {}", request.pictures),
                     fmt::format("The {} backend draws no pictures", request.backend),
                     fmt::format("Remove --pictures or --backend {}", request.backend), ErrorKind::misuse};
    }
    const std::vector<Output> outputs = outputs_of(request);
    const std::string beside = std::filesystem::path(request.model_file).replace_extension(".path.csv").string();
    const std::string costs = cost_table_file(state_directory(request.state_dir));
    for (std::size_t i = 0; i < outputs.size(); ++i) {
        const Output& out = outputs[i];
        const bool recorded = request.input_file != live_input && request.input_file != window_input;
        for (const std::string& in : {request.model_file, request.path_file, recorded ? request.input_file : std::string(),
                                      request.steering_file, request.config_file, beside, costs}) {
            if (!in.empty() && same_file(out.file, in))
                return Error{out.option + " " + out.file, "The output is a file that the walk reads", "Name another file",
                             ErrorKind::misuse};
        }
        for (std::size_t k = 0; k < i; ++k) {
            if (same_file(out.file, outputs[k].file)) {
                return Error{out.option + " " + out.file, "The same file is written by " + outputs[k].option, "Name another file",
                             ErrorKind::misuse};
            }
        }
        if (auto ok = probe_writable(out.file, out.in_folder); !ok) {
            return Error{out.option + " " + ok.error().place, ok.error().what, ok.error().remedy, ok.error().kind};
        }
    }
    return {};
}

}  // namespace surefoot::walk
