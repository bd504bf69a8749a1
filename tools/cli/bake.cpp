// surefoot bake: imports model files, clusters, simplifies, captures, and writes a .walk model.
#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <map>
#include <span>

#include <fmt/format.h>
#include <sys/resource.h>

#include "render/bake/bake.hpp"
#include "render/import/formats.hpp"
#include "render/model/walk_file.hpp"
#include "rt/base/file.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/options.hpp"
#include "tools/cli/walk_settings.hpp"
#include "tools/walk/state.hpp"

namespace surefoot::cli {

namespace {
struct BakeArguments {
    std::vector<std::string> in;
    std::string out, quality = "draft", state;
    double level_ratio = 0;
    model::SunTime sun;
    CLI::Option* sun_hour = nullptr;
    double fog_visibility_m = 0;
    CLI::Option* fog = nullptr;
    std::shared_ptr<SettingArguments> settings = std::make_shared<SettingArguments>();
    bool allow_incomplete = false, whole_objects = false, water = false, sky = false, light_by_pixel = false, json = false;
};

constexpr std::array<std::string_view, 2> qualities = {"draft", "full"};

double peak_memory_mib() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

/// A missing texture should stop the bake, so that visitors of a kiosk never see a white wall.
Error incomplete(std::span<const importer::Damage> damage) {
    std::string what = "The scene is incomplete: " + damage[0].what;
    for (std::size_t i = 1; i < std::min<std::size_t>(damage.size(), 3); ++i) what += "; " + damage[i].what;
    if (damage.size() > 3) what += fmt::format("; and {} more", damage.size() - 3);
    return {damage[0].file, what, "Repair it, or bake what is left with --allow-incomplete", ErrorKind::damaged};
}

/// How long each stage took. Progress messages name a stage when it ends, so the time since the last message is that stage's.
class StageTimes {
public:
    void see(std::string_view stage) {
        const auto now = std::chrono::steady_clock::now();
        const std::string name(stage);
        seconds_[name] = seconds_.value(name, 0.0) + std::chrono::duration<double>(now - last_).count();
        last_ = now;
    }
    [[nodiscard]] const nlohmann::ordered_json& json() const { return seconds_; }

private:
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
    nlohmann::ordered_json seconds_ = nlohmann::ordered_json::object();
};

/// Each once with its number, the first dozen of them: the rest is in the model.
void print_warnings(const std::vector<std::string>& warnings) {
    constexpr std::size_t max_kinds = 12;
    std::map<std::string_view, std::size_t> times;
    std::vector<std::string_view> kinds;
    for (const std::string& warning : warnings)
        if (++times[warning] == 1) kinds.push_back(warning);
    for (std::size_t i = 0; i < std::min(kinds.size(), max_kinds); ++i)
        notify(times[kinds[i]] > 1 ? fmt::format("{} ({} times)", kinds[i], times[kinds[i]]) : std::string(kinds[i]));
    if (kinds.size() > max_kinds)
        notify(fmt::format("{} more kinds of warnings are not shown. `surefoot inspect` lists all.", kinds.size() - max_kinds));
}

bake::BakeOptions options_of(const BakeArguments& a, const config::Settings& settings, const model::CostModel& costs) {
    bake::BakeOptions options;
    options.quality = a.quality == "full" ? bake::Quality::full : bake::Quality::draft;
    options.whole_objects = a.whole_objects;
    options.level_ratio = a.level_ratio * 0.01;
    if (a.sun_hour->count() > 0) options.sun = a.sun;
    if (a.fog->count() > 0) options.fog_visibility_m = a.fog_visibility_m;
    options.water_by_name = a.water;
    options.light_by_pixel = a.light_by_pixel;
    options.sky = a.sky;
    options.workers = settings.workers;
    options.frame_us = 1e6 / settings.rate_hz;
    options.costs = &costs;
    return options;
}

int run_bake(const BakeArguments& a, const Context& context) {
    const auto begun = std::chrono::steady_clock::now();
    const auto settings = read_settings(*a.settings);
    if (!settings) return misuse(settings.error());
    for (const std::string& in : a.in) {
        std::error_code ignored;
        if (std::filesystem::equivalent(in, a.out, ignored)) {
            return misuse({a.out, "The output is one of the files to bake", "Name another file with -o", ErrorKind::misuse});
        }
    }
    // Pictures and buffers that the files to bake bring along are known only when these are read: no model has their endings.
    if (std::filesystem::path(a.out).extension() != ".walk") {
        return misuse({"-o " + a.out, "The output's name does not end in .walk", "Name a file MODEL.walk", ErrorKind::misuse});
    }
    if (a.sun_hour->count() > 0 && model::towards_sun(a.sun).y <= 0) {
        return misuse({fmt::format("--sun-hour {:g}", a.sun.hour), "The sun is below the horizon then",
                       "Name another hour (12 is noon), --sun-day or --latitude", ErrorKind::misuse});
    }
    if (auto ok = probe_writable(a.out); !ok) return fail(ok.error());
    Progress progress = terminal_progress(context);
    StageTimes times;
    progress.report = [&times, bar = progress.report](std::string_view stage, double done) {
        times.see(stage);
        if (bar) bar(stage, done);
    };
    std::string cost_note;
    auto costs = walk::load_costs(walk::state_directory(a.state), "", cost_note);
    if (!costs) return fail(costs.error());
    auto scene = importer::import_files(a.in, progress);
    if (!scene) return end_progress(context), fail(scene.error());
    if (!a.allow_incomplete && !scene->damage.empty()) return end_progress(context), fail(incomplete(scene->damage));
    const bake::BakeOptions options = options_of(a, settings->values, *costs);
    auto model = bake::bake(*scene, options, progress);
    if (!model) return end_progress(context), fail(model.error());
    auto written = model::write_walk(a.out, *model);
    times.see("write");
    end_progress(context);
    if (!written) return fail(written.error());
    if (!cost_note.empty()) notify(cost_note);
    print_warnings(model->provenance.warnings);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
    if (a.json) {
        print_json({{"file", a.out},
                    {"objects", model->object_count},
                    {"nodes", model->nodes.size()},
                    {"representations", model->reps.size()},
                    {"triangles", model->triangles()},
                    {"bytes", written->bytes},
                    {"seconds", seconds},
                    {"stages_s", times.json()},
                    {"peak_mib", peak_memory_mib()},
                    {"quality", a.quality},
                    {"warnings", model->provenance.warnings}});
    } else {
        fmt::print("{}: {} objects, {} triangles, {} nodes, {} forms; {:.1f} MiB; {:.1f} s, {:.0f} MiB of memory\n", a.out,
                   model->object_count, model->triangles(), model->nodes.size(), model->reps.size(),
                   static_cast<double>(written->bytes) / 1048576.0, seconds, peak_memory_mib());
    }
    return exit_success;
}
}  // namespace

void add_bake(CLI::App& app, Context& context) {
    auto a = std::make_shared<BakeArguments>();
    CLI::App* c = add_command(app, "bake", "Import scenes and write a .walk model with levels of detail",
                              "surefoot bake house.glb garden.obj -o home.walk", a->json);
    c->add_option("in", a->in,
                  "Input files (" + importer::endings_in_words() +
                      "); several files become one scene. Stand-ins are read from glTF (MSFT_lod, the extra stand_ins) and from "
                      "NAME.stand_ins.toml beside NAME.glb")
        ->required();
    c->add_option("-o,--out", a->out, "The .walk model to write; an older file is replaced only when the new one is complete")
        ->required();
    c->add_option(
         "--quality", a->quality,
         "draft: at most one minute per million triangles; full: tighter error bounds, and light of sky, shadows and lamps")
        ->check(one_of(qualities))
        ->capture_default_str();
    c->add_option(
         "--level-ratio", a->level_ratio,
         "Triangles of a level in % of the next finer one's, 30 to 97: more levels, and a longer bake. Default: 45, or 60 "
         "with --quality full")
        ->check(number_within(30, 97, "%"));
    c->add_flag("--whole-objects", a->whole_objects,
                "Cut an object into pieces only if it has too many triangles for one frame, and not because it is long");
    a->sun_hour = c->add_option("--sun-hour", a->sun.hour,
                                "Hour of the sun's own time, 12 is noon: where it shines from. Default: as the scene's distant "
                                "light does, else from the south-east, 53 degrees high. North is -Z")
                      ->check(number_within(0, 24, "h"));
    c->add_option("--sun-day", a->sun.day, "Day of the year for --sun-hour and the hours of a walk; 172 is 21 June")
        ->check(number_within(1, 365, ""))
        ->capture_default_str()
        ->needs(a->sun_hour);
    c->add_option("--latitude", a->sun.latitude_deg, "Degrees north of the equator for --sun-hour and the hours of a walk")
        ->check(number_within(-90, 90, "degrees"))
        ->capture_default_str()
        ->needs(a->sun_hour);
    a->fog = c->add_option("--fog", a->fog_visibility_m,
                           "Metres that one sees far in fog: what is black keeps 5 % of its contrast there. 0: none. "
                           "Default: extras.fog_visibility_m of the glTF scene")
                 ->check(number_within(0, 1e7, "m"));
    c->add_flag("--water", a->water,
                "Materials move like water if their names end with that word, as in Pond_Water. "
                "The extra 'water' of a glTF material, true or false, says it without this");
    c->add_flag("--light-by-pixel", a->light_by_pixel,
                "Lit materials are lit for each pixel, which takes longer. "
                "The extra 'light' of a glTF material, flat, vertex or pixel, says it of one");
    c->add_flag("--sky", a->sky,
                "A sky behind everything, with the sun in it. The extra 'sky' of a glTF scene, true, says it without this");
    add_setting(c, a->settings, "--workers", "workers", "Threads; 0: one per core. The result does not depend on it.");
    add_setting(c, a->settings, "--rate", "rate_hz", "Frame rate; no item of the model may cost more than 1/16 of a frame.");
    c->add_flag("--allow-incomplete", a->allow_incomplete,
                "Bake a scene with missing or damaged textures, materials or coordinates, and warn about them");
    c->add_option("--state", a->state, "Folder of the calibrated cost table");
    c->callback([&context, a] { context.run = [a, &context] { return run_bake(*a, context); }; });
}

}  // namespace surefoot::cli
