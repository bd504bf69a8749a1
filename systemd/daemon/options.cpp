// The command line, by CLI11.
#include "systemd/daemon/options.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <sstream>

#include "systemd/daemon/exit_code.hpp"

namespace surefoot::daemon {

namespace {

constexpr const char* what =
    "Walks through a 3D model in real time, for months: the service behind a kiosk or a simulator channel.\n\n"
    "All that it does is in one settings file. To begin with:\n"
    "  surefoot bake lobby.glb -o /var/lib/surefoot/lobby.walk   a model\n"
    "  surefoot config --print --defaults                        every key, with unit, limits and default\n"
    "  surefootd --check                                         is the file right?\n"
    "  systemctl start surefootd                                 then: systemctl status surefootd";

constexpr const char* ending =
    "Signals: SIGHUP reads the settings again (a file that is not right is refused, and the walk goes on as before); SIGTERM "
    "and\n"
    "SIGINT end it within two seconds.\n\n"
    "Under systemd (Type=notify) it is ready when frames are being run, says in its status what it lacks of real time, and "
    "feeds\n"
    "the watchdog only while frames come.\n\n"
    "Exit status: 0 ended as asked, 1 failure, 2 wrong use; 66 model, path, input or cost table cannot be read; 69 no graphics\n"
    "context, or it was lost; 70 a real-time thread never slept; 73 the state folder cannot be written; 77 `strict` and no real\n"
    "time; 78 the settings file.\n\n"
    "Examples:\n"
    "  surefootd --config lobby.toml\n"
    "  surefootd --config lobby.toml --check\n"
    "  surefootd --config lobby.toml --set backend=osmesa --set fifo=false      (a try-out on a desk)";

}  // namespace

std::optional<Options> read_options(int argc, char** argv, int& code) {
    Options options;
    CLI::App app{what, "surefootd"};
    app.footer(ending);
    app.set_version_flag("--version", SUREFOOT_VERSION);
    app.add_option("--config", options.config_file, "The settings file, TOML")->capture_default_str();
    app.add_option("--profile", options.profile, "Lay [profile.NAME] of the file over the rest");
    app.add_option("--set", options.set, "KEY=VALUE over the file; may be given more than once")->type_name("KEY=VALUE");
    app.add_flag("--check", options.check, "Say OK, or everything that is wrong in the settings file, and end");
    try {
        app.parse(argc, argv);
        return options;
    } catch (const CLI::ParseError& error) {
        std::ostringstream out, err;
        code = app.exit(error, out, err) == 0 ? exit_success : exit_usage;
        if (!err.str().empty()) (void)std::fprintf(stderr, "surefootd: %s (see surefootd --help)\n", error.what());
        const bool written = std::fputs(out.str().c_str(), stdout) >= 0 && std::fflush(stdout) == 0;
        if (!written && code == exit_success) code = exit_failure;
        return std::nullopt;
    }
}

}  // namespace surefoot::daemon
