// surefoot effects: the table of what a scene calls for and what it does not, with the reasons.
#include <fmt/format.h>

#include "render/effects/effects.hpp"
#include "render/model/walk_file.hpp"
#include "tools/cli/command.hpp"
#include "tools/report/terminal.hpp"

namespace surefoot::cli {

namespace {
struct EffectsArguments {
    std::string file;
    bool json = false;
};

int run_effects(const EffectsArguments& a) {
    auto m = model::read_walk(a.file);
    if (!m) return fail(m.error());
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    const report::Columns columns({{"effect", 14}, {"called for", 11}, {"triangles", -12}, {"reason", 0, 2}});
    if (!a.json) fmt::print("{}\n", columns.heading());
    for (const effects::EffectModule& effect : effects::all_effects()) {
        for (const model::EffectFinding& f : m->effects) {
            if (f.bit != effect.bit) continue;
            if (a.json) {
                list.push_back({{"effect", std::string(effect.name)},
                                {"what", std::string(effect.help)},
                                {"asked_by", std::string(effect.requested_by)},
                                {"called_for", f.called_for},
                                {"triangles", f.triangles},
                                {"reason", f.reason}});
            } else {
                fmt::print("{}\n", columns.row({std::string(effect.name), f.called_for ? "yes" : "no",
                                                std::to_string(f.triangles), f.reason}));
            }
        }
    }
    if (a.json) print_json({{"model", a.file}, {"effects", list}});
    return exit_success;
}
}  // namespace

void add_effects(CLI::App& app, Context& context) {
    auto a = std::make_shared<EffectsArguments>();
    CLI::App* c = add_command(app, "effects", "List the effects of a model with the reason for each; unused effects cost nothing",
                              "surefoot effects town.walk", a->json);
    c->add_option("model", a->file, "The .walk model")->required();
    c->callback([&context, a] { context.run = [a] { return run_effects(*a); }; });
}

}  // namespace surefoot::cli
