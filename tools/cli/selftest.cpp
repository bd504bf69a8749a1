// surefoot selftest: the hard cases, measured here: input, what must hold, what was found, its limit, and one line at the end.
#include <fmt/format.h>

#include <cmath>

#include "render/gl/backends.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/options.hpp"
#include "tools/selftest/hard.hpp"

namespace surefoot::cli {

namespace {

struct SelftestArguments {
    std::vector<std::string> rows;
    std::string backend;
    double scale = 1;
    bool hard = false, list = false, json = false;
};

nlohmann::ordered_json describe(const selftest::Row& row) {
    return {{"id", std::string(row.id)},
            {"family", std::string(row.family)},
            {"input", std::string(row.input)},
            {"must_hold", std::string(row.must_hold)}};
}

nlohmann::ordered_json number(double value) {
    if (std::isfinite(value)) return value;
    return nullptr;  // JSON has no word for it
}

nlohmann::ordered_json to_json(const selftest::RowResult& result) {
    nlohmann::ordered_json object = describe(*result.row);
    nlohmann::ordered_json figures = nlohmann::ordered_json::array();
    for (const selftest::Figure& f : result.outcome.figures)
        figures.push_back({{"name", f.name},
                           {"value", number(f.value)},
                           {"relation", std::string(selftest::word(f.relation))},
                           {"limit", number(f.limit)},
                           {"unit", f.unit},
                           {"holds", f.holds()}});
    object["verdict"] = std::string(selftest::word(result.verdict));
    object["figures"] = figures;
    object["scaled"] = result.outcome.scaled;
    object["not_run"] = result.outcome.not_run;
    object["triangles"] = result.outcome.triangles;
    object["cut_hash"] = fmt::format("{:016x}", result.outcome.cut_hash);
    object["digest"] = fmt::format("{:016x}", result.outcome.digest);
    object["seconds"] = std::round(result.seconds * 1000) / 1000;
    return object;
}

int list_rows(const SelftestArguments& a, std::span<const selftest::Row* const> selection) {
    if (a.json) {
        nlohmann::ordered_json rows = nlohmann::ordered_json::array();
        for (const selftest::Row* row : selection) rows.push_back(describe(*row));
        print_json({{"rows", rows}});
        return exit_success;
    }
    for (const selftest::Row* row : selection) fmt::print("{:<5} {}\n      must hold: {}\n", row->id, row->input, row->must_hold);
    return exit_success;
}

bool all_well(std::span<const selftest::RowResult> results) {
    for (const selftest::RowResult& r : results)
        if (r.verdict == selftest::Verdict::broken) return false;
    return true;
}

int run_selftest(const SelftestArguments& a, const Context& context) {
    if (!a.hard && !a.rows.empty()) {
        return misuse({a.rows.front(), "Rows are tested only with --hard", "Run: surefoot selftest --hard " + a.rows.front(),
                       ErrorKind::misuse});
    }
    if (!a.hard) return misuse({"selftest", "Nothing to test is named", "Run: surefoot selftest --hard", ErrorKind::misuse});
    const auto selection = selftest::select_rows(a.rows);
    if (!selection) return misuse(selection.error());
    if (a.list && !a.backend.empty())
        return misuse({"--backend", "--list runs nothing, so no backend draws", "Remove --backend or --list", ErrorKind::misuse});
    if (a.list) return list_rows(a, *selection);
    const Progress progress = terminal_progress(context);
    const auto results = selftest::run_rows(*selection, {a.scale, &progress, a.backend}, [&](const selftest::RowResult& r) {
        end_progress(context);
        if (a.json) return;
        fmt::print("{}", selftest::text_of(r));
        std::fflush(stdout);
    });
    end_progress(context);
    if (!results) return fail(results.error());
    const std::string summary = selftest::summary_of(*results);
    if (a.json) {
        nlohmann::ordered_json rows = nlohmann::ordered_json::array();
        for (const selftest::RowResult& r : *results) rows.push_back(to_json(r));
        print_json({{"rows", rows},
                    {"scale", a.scale},
                    {"digest", fmt::format("{:016x}", selftest::digest_of(*results))},
                    {"summary", summary}});
    } else {
        fmt::print("{}\n", summary);
    }
    return all_well(*results) ? exit_success : exit_failure;
}

}  // namespace

void add_selftest(CLI::App& app, Context& context) {
    auto a = std::make_shared<SelftestArguments>();
    CLI::App* c = add_command(
        app, "selftest", "Test hard numerical cases on this machine, each with its measured value and limit",
        "surefoot selftest --hard\n  surefoot selftest --hard N9 F1 --scale 10\n\nExit status: 0 no row is broken, 1 a row is "
        "broken, 2 "
        "wrong use.\nThe last line names rows that cannot run, for example without software GL. They count as neither.",
        a->json);
    c->add_flag("--hard", a->hard,
                "Run the hard cases: far from the origin, inside boxes, damaged meshes and files, endless runs");
    c->add_flag("--list", a->list, "List the rows and run none");
    c->add_option("ROW", a->rows, "Rows to run; N9 runs N9a and N9b (else all rows)");
    c->add_option("--scale", a->scale, "Factor on the number of samples")
        ->check(number_within(0.001, 100))
        ->capture_default_str();
    c->add_option("--backend", a->backend,
                  "Backend for rows that draw: " + gl::drawing_backends() + " (else the first that opens)")
        ->check(drawing_backend());
    c->callback([&context, a] { context.run = [&context, a] { return run_selftest(*a, context); }; });
}

}  // namespace surefoot::cli
