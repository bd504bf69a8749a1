// surefoot: bakes models, measures the machine, runs walks, and shows what accuracy costs. A thin main: one file a command.
#include <fmt/format.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <sstream>
#include <string_view>
#include <system_error>
#include <vector>

#include "config/wrong_use.hpp"
#include "render/gl/device.hpp"
#include "render/import/formats.hpp"
#include "rt/base/file.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/options.hpp"
#include "tools/report/terminal.hpp"

namespace {

std::atomic<bool> stop_requested{false};

/// First signal: stop safely. Second: the default action, for a user in a hurry.
void on_signal(int number) {
    stop_requested.store(true);
    std::signal(number, SIG_DFL);
}

/// Reports exceptions, and output that stdout refused. All other errors are values.
int run(const surefoot::cli::Context& context) {
    using namespace surefoot;
    int code = cli::exit_failure, output_error = 0;
    const auto unexpected = [](const std::exception& error) {
        cli::fail({"surefoot", std::string("An unexpected error happened: ") + error.what(),
                   "Please report this with the command line", ErrorKind::failed});
    };
    try {
        code = context.run();
    } catch (const std::bad_alloc&) {
        cli::fail({"memory", "There is not enough memory for this work",
                   "Close other programs, or use a machine with more memory", ErrorKind::no_memory});
    } catch (const std::system_error& error) {
        output_error = std::ferror(stdout) != 0 ? error.code().value() : 0;
        if (output_error == 0) unexpected(error);
    } catch (const std::exception& error) {
        unexpected(error);
    }
    return cli::finish_output(code, output_error);
}

void handle_signals() {
    std::signal(SIGINT, on_signal);
    std::signal(SIGTERM, on_signal);
    if (std::signal(SIGHUP, on_signal) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);  // nohup
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGXFSZ, SIG_IGN);  // a file limit is an error of that file, not the end of the program
}

/// In the order of the help.
void add_commands(CLI::App& app, surefoot::cli::Context& context) {
    using namespace surefoot;
    cli::add_scene(app, context);
    cli::add_bake(app, context);
    cli::add_inspect(app, context);
    cli::add_effects(app, context);
    cli::add_calibrate(app, context);
    cli::add_walk(app, context);
    cli::add_soak(app, context);
    cli::add_accuracy(app, context);
    cli::add_compare(app, context);
    cli::add_replay(app, context);
    cli::add_devices(app, context);
    cli::add_config(app, context);
    cli::add_doctor(app, context);
    cli::add_selftest(app, context);
    cli::add_cache_study(app, context);
    cli::add_status(app, context);
    cli::add_top(app, context);
    cli::add_manual(app, context);
}

}  // namespace

int main(int argc, char** argv) {
    using namespace surefoot;
    keep_standard_files();
    handle_signals();

    cli::Context context;
    context.stop = &stop_requested;
    context.terminal = isatty(STDERR_FILENO) == 1;
    context.colour = report::colour_wanted();

    CLI::App app{
        "Surefoot walks through 3D models that are too complex to draw in full, and finishes every frame by its deadline.\n\n"
        "First steps:\n"
        "  surefoot scene forest --scale 10 -o forest.glb     a model and a path (or bring your own: " +
            importer::endings_in_words() +
            ")\n"
            "  surefoot bake forest.glb -o forest.walk            prepare it\n"
            "  surefoot calibrate                                 measure this machine, once\n"
            "  surefoot walk forest.walk --path forest.path.csv --report report",
        "surefoot"};
    app.formatter(cli::help_formatter());  // before the commands, which take it over
    app.require_subcommand(1);
    app.set_version_flag("--version", SUREFOOT_VERSION);
    add_commands(app, context);
    app.failure_message([argc, argv](const CLI::App* of, const CLI::Error& error) {
        const std::vector<std::string_view> arguments(argv + 1, argv + argc);
        const Error wrong = config::wrong_use(*of, error, arguments, cli::renamed_options(), cli::hidden_group);
        return "surefoot: " + wrong.text() + "\n";
    });
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        std::ostringstream out, err;
        const int code = app.exit(error, out, err) == 0 ? cli::exit_success : cli::exit_usage;
        (void)std::fputs(err.str().c_str(), stderr);
        context.run = [text = out.str(), code] {
            fmt::print("{}", text);
            return code;
        };
    }
    gl::prepare_process(0);  // before any thread; a command that is told another number settles that first of all
    const int code = run(context);
    return code == cli::exit_failure && stop_requested.load() ? cli::exit_stopped : code;
}
