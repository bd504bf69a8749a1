// surefoot replay: repeats a captured frame's selection off line, by its own selector or by another.
#include <fmt/format.h>

#include "render/capture/capture.hpp"
#include "render/select/oracle.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/options.hpp"
#include "tools/report/terminal.hpp"

namespace surefoot::cli {

namespace {
struct ReplayArguments {
    std::string file;
    std::vector<std::string> selectors;
    bool json = false;
};

nlohmann::ordered_json cut_json(const std::string& selector, const select::Cut& cut) {
    return {{"selector", selector},
            {"hash", fmt::format("{:016x}", cut.hash)},
            {"items", cut.items.size()},
            {"predicted_us", cut.predicted_us},
            {"floor_us", cut.floor_us},
            {"floor_binds", cut.floor_binds},
            {"triangles", cut.triangles},
            {"refinements", cut.refinements},
            {"value", cut.value + cut.bought.value},
            {"bought_items", cut.bought.count},
            {"guarantee", rt::name_of(cut.guarantee)},
            {"accuracy", cut.worst_error_rad > model::exact_up_to_rad ? nlohmann::ordered_json(1.0 / cut.worst_error_rad)
                                                                      : nlohmann::ordered_json(nullptr)}};
}

int run_replay(const ReplayArguments& a) {
    auto captured = capture::read_capture(a.file);
    if (!captured) return fail(captured.error());
    if (auto same = capture::verify(*captured); !same) {
        return fail({a.file + ", " + same.error().place, same.error().what, same.error().remedy, same.error().kind});
    }
    std::vector<std::string> selectors{captured->selector};
    selectors.insert(selectors.end(), a.selectors.begin(), a.selectors.end());
    std::vector<select::Cut> cuts;  // all of them before a word is said
    for (const std::string& selector : selectors) {
        auto cut = capture::replay(*captured, selector);
        if (!cut) return fail(cut.error());
        cuts.push_back(std::move(*cut));
    }
    if (a.json) {
        nlohmann::ordered_json list = nlohmann::ordered_json::array();
        for (std::size_t i = 0; i < cuts.size(); ++i) list.push_back(cut_json(selectors[i], cuts[i]));
        print_json({{"capture", a.file},
                    {"frame", captured->frame},
                    {"candidates", captured->prepared.candidates.size()},
                    {"budget_us", captured->budget_us},
                    {"same_cut", true},
                    {"cuts", list}});
        return exit_success;
    }
    fmt::print("{}: frame {}, {} candidates, budget {:.2f} ms; the repeated cut is equal\n", a.file, captured->frame,
               captured->prepared.candidates.size(), captured->budget_us * 1e-3);
    const report::Columns columns({{"selector", 18},
                                   {"hash", -16},
                                   {"items", -7},
                                   {"predicted us", -13},
                                   {"triangles", -10},
                                   {"refinements", -12},
                                   {"value", -10}});
    fmt::print("{}\n", columns.heading());
    for (std::size_t i = 0; i < cuts.size(); ++i)
        fmt::print("{}\n", columns.row({selectors[i], fmt::format("{:016x}", cuts[i].hash), std::to_string(cuts[i].items.size()),
                                        fmt::format("{:.0f}", cuts[i].predicted_us), std::to_string(cuts[i].triangles),
                                        std::to_string(cuts[i].refinements),
                                        fmt::format("{:.0f}", cuts[i].value + cuts[i].bought.value)}));
    return exit_success;
}
}  // namespace

void add_replay(CLI::App& app, Context& context) {
    auto a = std::make_shared<ReplayArguments>();
    CLI::App* c = add_command(
        app, "replay", "Repeat the selection of a captured frame; any difference to the captured cut is an error",
        "surefoot walk town.walk --capture frame.cap --capture-frame 120\n  surefoot replay frame.cap --selector best-first",
        a->json);
    c->add_option("capture", a->file, "File from `surefoot walk --capture`")->required();
    std::vector<std::string_view> names(select::selector_names().begin(), select::selector_names().end());
    names.push_back(select::oracle_name);
    c->add_option("--selector", a->selectors,
                  "Additional selectors to run on the same frame; oracle: the greatest value, in seconds")
        ->check(one_of(names));
    c->callback([&context, a] { context.run = [a] { return run_replay(*a); }; });
}

}  // namespace surefoot::cli
