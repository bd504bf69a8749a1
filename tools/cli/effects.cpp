// surefoot effects: what a scene calls for and what it does not, with the reasons; with --report, what each costs and shows.
#include <fmt/format.h>

#include "render/effects/effects.hpp"
#include "render/model/walk_file.hpp"
#include "tools/accuracy/curved_triangles.hpp"
#include "tools/accuracy/effect_regions.hpp"
#include "tools/accuracy/effect_worth.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/options.hpp"
#include "tools/cli/walk_settings.hpp"
#include "tools/report/terminal.hpp"

namespace surefoot::cli {

namespace {
struct EffectsArguments {
    accuracy::PlacesRequest request;
    std::shared_ptr<SettingArguments> settings = std::make_shared<SettingArguments>();
    std::string report;
    bool json = false;
};

void print_tables(const accuracy::EffectReport& report) {
    const report::Columns columns(
        {{"without", 14}, {"places", -7}, {"frames", -8}, {"with ms", -9}, {"without ms", -11}, {"PSNR dB", -8}, {"FLIP", -7}});
    fmt::print("{}\n", columns.heading());
    const auto decibels = [](const accuracy::PictureDifference& d) {
        return d.psnr_db < report::max_psnr_db ? fmt::format("{:.1f}", d.psnr_db) : std::string("equal");
    };
    const auto row = [&](const std::string& name, std::uint32_t places, double frames, const accuracy::WithAndWithout& w) {
        fmt::print("{}\n", columns.row({name, std::to_string(places), fmt::format("{:.1f} %", 100 * frames),
                                        fmt::format("{:.2f}", w.with_ms), fmt::format("{:.2f}", w.without_ms), decibels(w),
                                        fmt::format("{:.4f}", w.flip)}));
    };
    for (const accuracy::EffectWorth& e : report.effects)
        if (e.shown_at > 0) row(e.name, e.shown_at, e.frames_share, e.worth);
    row("all: bare", report.poses, 1, report.bare);
    const report::Columns ways({{"drawn", 14}, {"ms", -7}, {"PSNR dB", -8}, {"programs", -9}, {"batches", -9}, {"changes", -9}});
    fmt::print("\n{}\n", ways.heading());
    const auto way = [&](const std::string& name, const accuracy::Way& w, const std::string& psnr) {
        fmt::print("{}\n", ways.row({name, fmt::format("{:.2f}", w.ms), psnr, std::to_string(w.programs),
                                     fmt::format("{:.0f}", w.batches), fmt::format("{:.0f}", w.state_changes)}));
    };
    way("all on", report.ways.all_on, decibels(report.ways.all_on.difference));
    way("as called for", report.ways.as_called_for, "");
    way("bare", report.ways.bare, decibels(report.ways.bare.difference));
}

int run_report(EffectsArguments& a, const Context& context) {
    const auto read = read_settings(*a.settings);
    if (!read) return misuse(read.error());
    a.request.width = read->values.width;
    a.request.height = read->values.height;
    a.request.lift_m = read->values.lift_m;
    a.request.rasterisers = read->values.rasterisers;
    gl::prepare_process(a.request.rasterisers);
    if (auto ok = accuracy::probe_effects_page(a.report); !ok) return fail(ok.error());
    auto report = accuracy::measure_effects(a.request, terminal_progress(context));
    end_progress(context);
    if (!report) return fail(report.error());
    if (auto ok = accuracy::write_effects_page(a.report, *report); !ok) return fail(ok.error());
    if (a.json) {
        fmt::print("{}", accuracy::effects_json(*report));
        return exit_success;
    }
    print_tables(*report);
    fmt::print("page: {}/index.html\n", a.report);
    return exit_success;
}

nlohmann::ordered_json json_of(const std::vector<accuracy::EffectRegion>& regions) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const accuracy::EffectRegion& region : regions) {
        nlohmann::ordered_json effects = nlohmann::ordered_json::array();
        for (const accuracy::RegionEffect& e : region.effects)
            effects.push_back({{"effect", e.name},
                               {"called_for", e.called_for},
                               {"coarse_forms_alone", e.coarse_only},
                               {"triangles", e.triangles},
                               {"reason", e.reason}});
        const Box& box = region.box;
        list.push_back({{"node", region.node},
                        {"name", region.name},
                        {"box_m", {{box.min.x, box.min.y, box.min.z}, {box.max.x, box.max.y, box.max.z}}},
                        {"leaves", region.leaves},
                        {"triangles", region.triangles},
                        {"effects", effects}});
    }
    return list;
}

void print_regions(const std::vector<accuracy::EffectRegion>& regions) {
    fmt::print("\nregions of the hierarchy:\n");
    for (const accuracy::EffectRegion& region : regions) {
        fmt::print("  node {}, {}: {} triangles\n    {}\n", region.node, region.name, region.triangles,
                   accuracy::effects_in_words(region));
        for (const std::string& line : accuracy::reason_lines(region)) fmt::print("      {}\n", line);
    }
}

int run_effects(const EffectsArguments& a) {
    auto m = model::read_walk(a.request.model_file);
    if (!m) return fail(m.error());
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    const report::Columns columns({{"effect", 14}, {"called for", 11}, {"triangles", -12}, {"reason", 0, 2}});
    if (!a.json) fmt::print("{}\n", columns.heading());
    const auto show = [&](std::string_view name, std::string_view what, std::string_view requested_by,
                          const model::EffectFinding& f, const std::string& more = "") {
        // What a file does not say is explained by what would call for it.
        std::string reason = f.looked_for ? f.reason : fmt::format("{}; it takes {}", f.reason, requested_by);
        if (!more.empty()) reason += "; " + more;
        if (a.json) {
            list.push_back({{"effect", std::string(name)},
                            {"what", std::string(what)},
                            {"asked_by", std::string(requested_by)},
                            {"called_for", f.called_for},
                            {"triangles", f.triangles},
                            {"reason", reason}});
        } else {
            fmt::print("{}\n",
                       columns.row({std::string(name), f.called_for ? "yes" : "no", std::to_string(f.triangles), reason}));
        }
    };
    for (const effects::EffectModule& effect : effects::all_effects())
        for (const model::EffectFinding& f : m->effects)
            if (f.bit == effect.bit)
                show(effect.name, effect.help, effect.requested_by, f,
                     f.bit == model::effect_light_by_pixel ? in_words(accuracy::curved_triangles(*m)) : "");
    show("motion", "nodes move as animations say, and loop; no program of its own", "animated nodes", model::motion_finding(*m));
    const std::vector<accuracy::EffectRegion> regions = accuracy::regions_of(*m);
    if (a.json) {
        print_json({{"model", a.request.model_file}, {"effects", list}, {"regions", json_of(regions)}});
    } else {
        print_regions(regions);
    }
    return exit_success;
}
}  // namespace

void add_effects(CLI::App& app, Context& context) {
    auto a = std::make_shared<EffectsArguments>();
    CLI::App* c = add_command(
        app, "effects", "List the effects of a model and of its regions, with the reason for each; unused effects cost nothing",
        "surefoot effects town.walk\n  surefoot effects town.walk --report effects", a->json);
    accuracy::PlacesRequest& r = a->request;
    c->add_option("model", r.model_file, "The .walk model")->required();
    CLI::Option* report =
        c->add_option("--report", a->report,
                      "Folder for a page: where and how often each effect is in use, what it costs and shows; all on, and bare")
            ->check(names_something());
    c->add_option("--path", r.path_file, "CSV file of the path along which places are taken (else MODEL.path.csv, else a tour)")
        ->needs(report);
    c->add_option("--poses", r.poses, "Number of places along the path, 1 to 256")
        ->check(whole_number_within(1, 256))
        ->capture_default_str()
        ->needs(report);
    c->add_option("--repeats", r.repeats, "Timed repetitions per place; the median is used")
        ->check(whole_number_within(1, 100))
        ->capture_default_str()
        ->needs(report);
    c->add_option("--size", a->settings->size, "Size of the picture in pixels [1280x720]")->needs(report);
    c->add_option("--hour", r.hour, "Hour of the day whose light is drawn, 0 to 24. Default: as the model was baked")
        ->check(number_within(0, 24, "h"))
        ->needs(report);
    add_time(c, r.time_s)->needs(report);
    add_setting(c, a->settings, "--lift", "lift_m");
    c->add_option("--backend", r.backend, "Backend that draws: " + gl::drawing_backends())
        ->check(drawing_backend())
        ->capture_default_str()
        ->needs(report);
    add_setting(c, a->settings, "--rasterisers", "rasterisers", "Threads of a software renderer; 0: the measured default.");
    for (const char* name : {"--lift", "--rasterisers"}) c->get_option(name)->needs(report);
    c->add_option("--state", r.state_dir, "Folder of the calibrated cost table")->needs(report);
    c->callback(
        [&context, a] { context.run = [a, &context] { return a->report.empty() ? run_effects(*a) : run_report(*a, context); }; });
}

}  // namespace surefoot::cli
