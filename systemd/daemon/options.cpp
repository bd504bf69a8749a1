// The command line, by CLI11.
#include "systemd/daemon/options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cstdio>
#include <span>
#include <sstream>
#include <string_view>

#include "config/manual_from_cli.hpp"
#include "config/wrong_use.hpp"
#include "rt/base/named.hpp"
#include "systemd/daemon/exit_code.hpp"

namespace surefoot::daemon {

namespace {

/// Options of this group are taken, and left out of the manual page.
constexpr const char* hidden_group = "Build";

constexpr const char* what =
    "Walks through a 3D model in real time: the service for kiosks and simulator channels, made to run for months.\n\n"
    "One settings file configures it. First steps:\n"
    "  surefoot bake lobby.glb -o /var/lib/surefoot/lobby.walk   prepare a model\n"
    "  surefoot config --print --defaults                        list every key with unit, limits and default\n"
    "  surefootd --check                                         check the file\n"
    "  systemctl start surefootd                                 start; then: systemctl status surefootd";

constexpr const char* under_systemd =
    "Under systemd (Type=notify) the service is ready when the first frames are presented. Its status line names what real time "
    "lacks. The watchdog is notified only while frames are presented.";

constexpr const char* examples =
    "Examples:\n"
    "  surefootd --config lobby.toml\n"
    "  surefootd --config lobby.toml --check\n"
    "  surefootd --config lobby.toml --set backend=osmesa --set fifo=false      try it on a desk\n"
    "  journalctl -u surefootd SUREFOOT_EVENT=misses";

constexpr std::array signals = {
    Named{"SIGHUP",
          "Reads the settings again. A wrong file is refused, and the walk goes on unchanged. If no walk can start with the "
          "new settings, the old ones are used again. A new number of rasterisers needs a restart."},
    Named{"SIGTERM", "The service ends within two seconds. SIGINT does the same."},
};

constexpr std::array exit_statuses = {
    Named{"0", "The service ended as requested."},
    Named{"1", "A failure without its own number. With --check: the settings file has errors."},
    Named{"2", "Wrong use."},
    Named{"66", "The model, path, steering file, recording or cost table cannot be read."},
    Named{"69", "There is no graphics context, or it was lost."},
    Named{"70", "A real-time thread ran without sleeping. Its priority was taken first."},
    Named{"73", "The state folder cannot be written, so an emergency stop would be forgotten."},
    Named{"77", "The setting strict is on, and the machine refuses what real time needs."},
    Named{"78", "The settings file has errors."},
};

constexpr std::array files = {
    Named{"/etc/surefoot/surefoot.toml", "The settings: surefoot.toml(5)."},
    Named{"/var/lib/surefoot", "The cost table of surefoot-calibrate(1), and a latched emergency stop."},
    Named{"/run/surefoot/surefoot.sock", "Live figures for surefoot-top(1), surefoot-status(1) and Prometheus (/metrics)."},
    Named{"/usr/share/doc/surefoot/examples", "Drop-ins for a kiosk's screen, a simulator's channel and a hardware driver."},
};

std::string listed(const char* title, std::span<const Named> list) {
    std::string text = std::string(title) + ":\n";
    for (const Named& entry : list) text += fmt::format("  {:<8} {}\n", entry.name, entry.help);
    return text + "\n";
}

std::string manual(const CLI::App& app) {
    config::ManualPage page = config::manual_from_cli(app, "surefootd", 8, hidden_group);
    std::erase_if(page.sections, [](const config::ManualSection& section) { return section.title == "NOTES"; });
    page.sections[0].text += std::string("\n\n") + under_systemd;
    const auto add = [&page](const char* title, std::span<const Named> list) {
        config::ManualSection section{title, "", {}};
        for (const Named& entry : list) section.items.push_back({std::string(entry.name), std::string(entry.help)});
        page.sections.push_back(std::move(section));
    };
    add("SIGNALS", signals);
    add("EXIT STATUS", exit_statuses);
    add("FILES", files);
    page.sections.push_back({"EXAMPLES", std::string_view(examples).substr(std::string_view("Examples:\n").size()).data(), {}});
    page.sections.push_back({"SEE ALSO", "surefoot(1), surefoot.toml(5), surefoot-doctor(1), systemctl(1)", {}});
    return config::troff(page, SUREFOOT_VERSION);
}

}  // namespace

std::optional<Options> read_options(int argc, char** argv, int& code) {
    Options options;
    CLI::App app{what, "surefootd"};
    app.footer(std::string(under_systemd) + "\n\n" + listed("Signals", signals) + listed("Exit status", exit_statuses) +
               examples);
    app.set_version_flag("--version", SUREFOOT_VERSION);
    app.add_option("--config", options.config_file, "Settings file (TOML)")->capture_default_str();
    app.add_option("--profile", options.profile, "Apply the table [profile.NAME] of the file");
    app.add_option("--set", options.set, "Set a key, over the file; may be repeated")->type_name("KEY=VALUE");
    app.add_flag("--check", options.check, "Check the settings file, print OK or every error, and exit");
    bool write_manual = false;
    app.add_flag("--manual", write_manual, "Print the manual page; the build uses it")->group(hidden_group);
    try {
        app.parse(argc, argv);
        if (!write_manual) return options;
        const bool printed = std::fputs(manual(app).c_str(), stdout) >= 0 && std::fflush(stdout) == 0;
        code = printed ? exit_success : exit_failure;
        return std::nullopt;
    } catch (const CLI::ParseError& error) {
        std::ostringstream out, err;
        code = app.exit(error, out, err) == 0 ? exit_success : exit_usage;
        const std::vector<std::string_view> arguments(argv + 1, argv + argc);
        if (!err.str().empty())
            (void)std::fprintf(stderr, "surefootd: %s\n",
                               config::wrong_use(app, error, arguments, {}, hidden_group).text().c_str());
        const bool written = std::fputs(out.str().c_str(), stdout) >= 0 && std::fflush(stdout) == 0;
        if (!written && code == exit_success) code = exit_failure;
        return std::nullopt;
    }
}

}  // namespace surefoot::daemon
