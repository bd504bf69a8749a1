// surefoot inspect: what is in a .walk model, in figures or in pictures.
#include <cmath>
#include <filesystem>
#include <optional>

#include <fmt/format.h>

#include "render/effects/effects.hpp"
#include "render/model/form_range.hpp"
#include "render/model/model.hpp"
#include "render/model/walk_file.hpp"
#include "rt/base/file.hpp"
#include "rt/base/statistics.hpp"
#include "tools/accuracy/form_pictures.hpp"
#include "tools/accuracy/model_curve.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/options.hpp"
#include "tools/report/floor_plan.hpp"
#include "tools/walk/path_source.hpp"

namespace surefoot::cli {

namespace {
struct InspectArguments {
    std::string file;
    bool tree = false;
    double accuracy = 0;  ///< that forms are to have in their ranges, rad^-1; 0: no ranges
    bool json = false;
    std::optional<std::string> pictures;    ///< folder of the page
    std::string map, path;                  ///< the floor plan's file; the path on it
    std::string curve;                      ///< the chart's file
    accuracy::FormPicturesRequest request;  ///< its model is `file`
};

std::string rep_name(model::RepKind kind) { return std::string(model::form_of(kind).name); }

/// From which distance to the middle of the node which form is drawn, where all have at least that accuracy.
std::string drawn_from(const model::Model& m, model::Index n, double accuracy) {
    const model::Node& node = m.nodes[n];
    const std::vector<model::RangedLevel> levels = model::levels_of(m, n, 1 / accuracy);
    std::string out;
    for (const model::LevelFrom& from : model::levels_along(levels, node.box.centre(), {1, 0, 0})) {
        out += fmt::format("{}from {:.4g} m ", out.empty() ? "  " : ", ", from.from_m);
        if (from.level == levels.size()) {
            out += node.child_count > 0 ? "the children" : "none";
            continue;
        }
        const model::Representation& rep = m.reps[node.first_rep + from.level];
        out += fmt::format("{}:{}", rep_name(rep.kind), rep.triangles);
    }
    return out;
}

void print_tree(const model::Model& m, double accuracy) {
    struct Open {
        model::Index node;
        int depth;
    };
    std::vector<Open> open{{0, 0}};
    while (!open.empty()) {
        const Open at = open.back();
        open.pop_back();
        const model::Node& node = m.nodes[at.node];
        fmt::print("{:{}}{} {} {} triangles", "", at.depth * 2, model::name_of(node.kind), m.name_of(node), node.triangles);
        for (model::Index r = node.first_rep; r < node.first_rep + node.rep_count; ++r) {
            fmt::print("  {}:{}@{:.3g}m", rep_name(m.reps[r].kind), m.reps[r].triangles, m.reps[r].error_m);
        }
        if (accuracy > 0) fmt::print("{}", drawn_from(m, at.node, accuracy));
        fmt::print("\n");
        for (std::uint32_t c = node.child_count; c > 0; --c) open.push_back({node.first_child + c - 1, at.depth + 1});
    }
}

nlohmann::ordered_json range_json(const model::ConicRange& range) {
    if (range.empty()) return nullptr;
    const auto number = [](double value) { return std::isfinite(value) ? nlohmann::ordered_json(value) : nullptr; };
    return {{"centre_m", {range.centre.x, range.centre.y, range.centre.z}},
            {"distance_m", {range.min_m, number(range.max_m)}},
            {"direction", {range.direction.x, range.direction.y, range.direction.z}},
            {"alpha_rad", range.alpha_rad}};
}

/// The range of each form, and which one is drawn from which distance on; null: none of them.
void add_ranges(const model::Model& m, model::Index n, double accuracy, nlohmann::ordered_json& node) {
    const std::vector<model::RangedLevel> levels = model::levels_of(m, n, 1 / accuracy);
    for (std::size_t i = 0; i < levels.size(); ++i) node["representations"][i]["range"] = range_json(levels[i].range);
    node["drawn"] = nlohmann::ordered_json::array();
    for (const model::LevelFrom& from : model::levels_along(levels, m.nodes[n].box.centre(), {1, 0, 0}))
        node["drawn"].push_back(
            {{"from_m", from.from_m},
             {"representation", from.level < levels.size() ? nlohmann::ordered_json(from.level) : nlohmann::ordered_json()}});
}

/// One object with a flat list, a node a line and never all of them in memory: models have millions.
void print_tree_json(const std::string& file, const model::Model& m, double accuracy) {
    fmt::print("{{\n\"file\": {},\n\"nodes\": [", json_text(file, -1));
    std::vector<model::Index> parents(m.nodes.size(), model::none);
    for (model::Index n = 0; n < m.nodes.size(); ++n) {
        const model::Node& node = m.nodes[n];
        for (std::uint32_t c = 0; c < node.child_count; ++c) parents[node.first_child + c] = n;
    }
    for (model::Index n = 0; n < m.nodes.size(); ++n) {
        const model::Node& node = m.nodes[n];
        nlohmann::ordered_json reps = nlohmann::ordered_json::array();
        for (model::Index r = node.first_rep; r < node.first_rep + node.rep_count; ++r) {
            reps.push_back({{"kind", rep_name(m.reps[r].kind)},
                            {"triangles", m.reps[r].triangles},
                            {"error_m", m.reps[r].error_m},
                            {"everywhere", m.reps[r].everywhere}});
        }
        const nlohmann::ordered_json parent =
            parents[n] == model::none ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(parents[n]);
        nlohmann::ordered_json one = {{"id", n},
                                      {"parent", parent},
                                      {"kind", model::name_of(node.kind)},
                                      {"name", std::string(m.name_of(node))},
                                      {"triangles", node.triangles},
                                      {"representations", reps}};
        if (accuracy > 0) add_ranges(m, n, accuracy, one);
        fmt::print("{}\n{}", n == 0 ? "" : ",", json_text(one, -1));
    }
    fmt::print("\n]\n}}\n");
}

nlohmann::ordered_json effects_json(const model::Model& m) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const model::EffectFinding& f : m.effects) {
        for (const effects::EffectModule& effect : effects::all_effects())
            if (f.bit == effect.bit && f.called_for) list.push_back(std::string(effect.name));
    }
    return list;
}

/// Of the forms that are not full detail: the median of how far their pictures are off, as mean squared error at middle size.
double median_loss(const model::Model& m, bool leaves) {
    std::vector<double> losses;
    for (const model::Node& node : m.nodes) {
        if ((node.child_count == 0) != leaves) continue;
        for (model::Index r = node.first_rep; r < node.first_rep + node.rep_count; ++r)
            if (!model::is_full_detail(node, r, m.reps[r].error_m)) losses.push_back(static_cast<double>(m.losses[r].colour[1]));
    }
    return losses.empty() ? 0 : median_of(losses);
}

int run_pictures(InspectArguments& a, const Context& context) {
    if (a.pictures->empty())
        return misuse({"--pictures ''", "The folder has no name", "Name the folder of the page", ErrorKind::misuse});
    a.request.model_file = a.file;
    gl::prepare_process(0);
    if (auto ok = accuracy::probe_forms_page(*a.pictures); !ok) return fail(ok.error());
    auto drawn = accuracy::draw_forms(a.request, terminal_progress(context));
    end_progress(context);
    if (!drawn) return fail(drawn.error());
    if (!drawn->uncalibrated.empty()) notify("The figures are uncalibrated: " + drawn->uncalibrated + ".");
    if (auto w = accuracy::write_forms_page(*a.pictures, *drawn); !w) return fail(w.error());
    const std::string page = *a.pictures + "/index.html";
    std::size_t forms = 0;
    for (const accuracy::DrawnNode& node : drawn->drawn) forms += node.forms.size();
    if (a.json) {
        print_json({{"page", page},
                    {"nodes", drawn->nodes},
                    {"distinct", drawn->distinct},
                    {"drawn", drawn->drawn.size()},
                    {"forms", forms},
                    {"renderer", drawn->renderer}});
    } else {
        fmt::print("{} forms of {} nodes, of {} with forms of their own\npage: {}\n", forms, drawn->drawn.size(), drawn->distinct,
                   page);
    }
    return exit_success;
}

/// The floor plan of a path: the requested one, or the one that a walk would follow.
int run_map(const InspectArguments& a) {
    if (!a.map.ends_with(".svg"))
        return misuse(
            {"--map " + a.map, "The floor plan's name does not end in .svg", "Name a file PLAN.svg", ErrorKind::misuse});
    if (auto ok = probe_writable(a.map); !ok) return fail(ok.error());
    auto m = model::read_walk(a.file);
    if (!m) return fail(m.error());
    auto chosen = walk::choose_path(a.path, a.file, *m, 0);
    if (!chosen) return fail(chosen.error());
    const std::string title = fmt::format("{}, {}", std::filesystem::path(a.file).stem().string(), chosen->source);
    if (auto w = write_text(a.map, report::floor_plan_svg(*m, chosen->path, title)); !w) return fail(w.error());
    if (a.json)
        print_json({{"map", a.map}, {"path", chosen->source}, {"seconds", chosen->path.duration_s()}});
    else
        fmt::print("map: {}\npath: {}\n", a.map, chosen->source);
    return exit_success;
}

int run_curve(const InspectArguments& a) {
    if (!a.curve.ends_with(".svg"))
        return misuse(
            {"--curve " + a.curve, "The chart's name does not end in .svg", "Name a file CURVE.svg", ErrorKind::misuse});
    if (auto ok = probe_writable(a.curve); !ok) return fail(ok.error());
    auto m = model::read_walk(a.file);
    if (!m) return fail(m.error());
    const auto found = accuracy::find_curve(a.file, *m, a.request.name);
    if (!found) return misuse(found.error());
    if (auto w = write_text(a.curve, accuracy::curve_svg(*found)); !w) return fail(w.error());
    if (a.json)
        fmt::print("{}\n", accuracy::curve_json(*found));
    else
        fmt::print("{}chart: {}\n", accuracy::curve_table(*found), a.curve);
    return exit_success;
}

int run_inspect(InspectArguments& a, const Context& context) {
    if (!a.map.empty()) return run_map(a);
    if (!a.curve.empty()) return run_curve(a);
    if (!a.request.name.empty() && !a.pictures)
        return misuse({"--node " + a.request.name, "This option has an effect with --pictures or --curve alone",
                       "Add one of them, or remove it", ErrorKind::misuse});
    if (a.pictures) return run_pictures(a, context);
    model::WalkFileInfo info;
    auto m = model::read_walk(a.file, &info);
    if (!m) return fail(m.error());
    if (a.tree && a.json) return print_tree_json(a.file, *m, a.accuracy), exit_success;
    if (a.tree) return print_tree(*m, a.accuracy), exit_success;
    std::uint64_t clusters = 0, pieces = 0;
    for (const model::Node& node : m->nodes) {
        clusters += node.kind == model::NodeKind::cluster;
        pieces += node.kind == model::NodeKind::piece;
    }
    std::map<std::string, std::uint64_t> kinds;
    for (const model::Representation& rep : m->reps) ++kinds[rep_name(rep.kind)];
    const Box& box = m->nodes[0].box;
    nlohmann::ordered_json losses(nullptr);  // null: not measured
    if (!m->losses.empty()) losses = {{"clusters", median_loss(*m, false)}, {"objects", median_loss(*m, true)}};
    print_json({{"file", a.file},
                {"objects", m->object_count},
                {"clusters", clusters},
                {"pieces", pieces},
                {"nodes", m->nodes.size()},
                {"representations", m->reps.size()},
                {"representation_kinds", kinds},
                {"median_loss", losses},
                {"triangles", m->triangles()},
                {"stored_triangles", m->indices.size() / 3},
                {"vertices", m->vertices.size()},
                {"materials", m->materials.size()},
                {"textures", m->textures.size()},
                {"bytes", info.bytes},
                {"payload_bytes", info.payload_bytes},
                {"pages", info.pages},
                {"effects", effects_json(*m)},
                {"ground",
                 {{"triangles", m->ground.triangles},
                  {"meshes", m->ground.meshes.size()},
                  {"instances", m->ground.instances.size()},
                  {"blocks", m->ground.blocks.size()},
                  {"moving", m->moving_ground.motions.size()},
                  {"bytes", model::bytes_of(m->ground)}}},
                {"tour", {{"kind", m->tour_kind}, {"samples", m->tour.samples.size()}, {"seconds", m->tour.duration_s()}}},
                {"box_m", {{box.min.x, box.min.y, box.min.z}, {box.max.x, box.max.y, box.max.z}}},
                {"sources", m->provenance.sources},
                {"quality", m->provenance.quality},
                {"warnings", m->provenance.warnings}});
    return exit_success;
}
}  // namespace

void add_inspect(CLI::App& app, Context& context) {
    auto a = std::make_shared<InspectArguments>();
    CLI::App* c = add_command(
        app, "inspect", "Print the contents of a .walk model as JSON",
        "surefoot inspect town.walk\n  surefoot inspect town.walk --pictures forms\n  surefoot inspect town.walk --map plan.svg",
        a->json);
    c->add_option("model", a->file, "The .walk model")->required();
    CLI::Option* tree = c->add_flag("--tree", a->tree,
                                    "Print the hierarchy instead: one line per node, with its forms as kind:triangles@error. "
                                    "With --json: a list with parents");
    c->add_option("--accuracy", a->accuracy,
                  "Of --tree: accuracy in rad^-1 that every form is to have. Adds which one is drawn from which distance to the "
                  "middle of its node. With --json: also for which eyes each form has it")
        ->check(number_within(1e-3, 1e9, "rad^-1"))
        ->needs(tree);
    CLI::Option* pictures =
        c->add_option("--pictures", a->pictures,
                      "Folder for a page instead: each form drawn beside full detail, with its error, look, cost and bytes");
    pictures->excludes(tree);
    CLI::Option* map = c->add_option("--map", a->map,
                                     "SVG file for a floor plan instead: what blocks a walker, with the path and its viewpoints");
    map->excludes(tree)->excludes(pictures);
    c->add_option(
         "--path", a->path,
         "Of --map: CSV file of poses over time, in place of the path that a walk would follow; `none`: round the model's box")
        ->needs(map);
    c->add_option("--nodes", a->request.max_nodes, "Of --pictures: the number of nodes, spread over the levels; 0: all")
        ->check(whole_number_within(0, 1'000'000))
        ->capture_default_str()
        ->needs(pictures);
    CLI::Option* node = c->add_option("--node", a->request.name,
                                      "Of --pictures: only nodes whose name contains this. Of --curve: the first of these");
    c->add_option(
         "--curve", a->curve,
         "SVG file for an accuracy curve instead: the triangles that each relative accuracy takes, of the model or of --node")
        ->check(names_something())
        ->excludes(tree)
        ->excludes(pictures)
        ->excludes(map);
    node->excludes(tree)->excludes(map);
    c->add_option("--backend", a->request.backend, "Of --pictures: backend that draws: " + gl::drawing_backends())
        ->check(drawing_backend())
        ->capture_default_str()
        ->needs(pictures);
    c->add_option("--state", a->request.state_dir, "Of --pictures: folder of the calibrated cost table")->needs(pictures);
    c->callback([&context, a] { context.run = [a, &context] { return run_inspect(*a, context); }; });
}

}  // namespace surefoot::cli
