// surefoot manual: writes the manual pages of the tool and of the settings file from --help and the schema. The build runs it.
#include <fmt/format.h>

#include <filesystem>
#include <span>

#include "config/manual_from_cli.hpp"
#include "rt/base/file.hpp"
#include "tools/cli/command.hpp"
#include "tools/walk/settings_request.hpp"

namespace surefoot::cli {

namespace {

using config::ManualPage;

void add_exit_codes(ManualPage& page) {
    page.sections.push_back(
        {"EXIT STATUS", "", {{"0", "Success."}, {"1", "Failure."}, {"2", "Wrong use."}, {"130", "Stopped by Ctrl-C."}}});
}

/// surefoot(1), a page a command and a page a command's command, surefoot.toml(5).
std::vector<ManualPage> pages_of(const CLI::App& app) {
    std::vector<ManualPage> pages;
    ManualPage top = config::manual_from_cli(app, "surefoot", 1, hidden_group);
    add_exit_codes(top);
    top.sections.push_back({"FILES",
                            "",
                            {{"~/.local/state/surefoot", "Cost tables, unless --state names another folder."},
                             {"/etc/surefoot/surefoot.toml", "Settings of the service."}}});
    std::string others = "surefootd(8), surefoot.toml(5)";
    const auto add = [&](const auto& self, const CLI::App& of, const std::string& prefix) -> void {
        for (const CLI::App* command : of.get_subcommands(nullptr)) {
            if (command->get_name().empty()) continue;
            const std::string words = prefix + " " + command->get_name();
            ManualPage page = config::manual_from_cli(*command, words, 1, hidden_group);
            add_exit_codes(page);
            page.sections.push_back({"SEE ALSO", "surefoot(1), surefoot.toml(5)", {}});
            others += ", " + page.name + "(1)";
            pages.push_back(std::move(page));
            self(self, *command, words);
        }
    };
    add(add, app, "surefoot");
    top.sections.push_back({"SEE ALSO", others, {}});
    pages.push_back(std::move(top));
    pages.push_back(config::settings_manual(walk::settings_schema()));
    return pages;
}

int run_manual(const CLI::App& app, const std::string& folder, bool json) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error)
        return fail({folder.empty() ? "-o ''" : folder, "The folder cannot be made: " + error.message(),
                     "Name another folder with -o", ErrorKind::unwritable});
    nlohmann::ordered_json files = nlohmann::ordered_json::array();
    for (const ManualPage& page : pages_of(app)) {
        const std::string file = fmt::format("{}/{}.{}", folder, page.name, page.section);
        const std::string text = config::troff(page, SUREFOOT_VERSION);
        if (auto written = write_file(file, std::as_bytes(std::span(text))); !written) return fail(written.error());
        files.push_back(file);
    }
    if (json) {
        print_json({{"files", files}});
    } else {
        fmt::print("{} manual pages in {}\n", files.size(), folder);
    }
    return exit_success;
}

}  // namespace

void add_manual(CLI::App& app, Context& context) {
    auto folder = std::make_shared<std::string>();
    auto json = std::make_shared<bool>(false);
    CLI::App* c = add_command(app, "manual", "Write the manual pages from --help and the settings schema",
                              "surefoot manual -o man && man man/surefoot-walk.1", *json);
    c->add_option("-o,--out", *folder, "Output folder; it is created if it does not exist")->required();
    c->callback(
        [&app, &context, folder, json] { context.run = [&app, folder, json] { return run_manual(app, *folder, *json); }; });
}

}  // namespace surefoot::cli
