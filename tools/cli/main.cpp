// surefoot: bakes models, measures the machine, runs walks, and shows what accuracy costs. A thin main: one file a command.
#include <csignal>
#include <cstdlib>
#include <new>

#include <unistd.h>

#include "tools/cli/command.hpp"

namespace {

std::atomic<bool> stop_requested{false};

/// First signal: stop safely. Second: the default action, for a user in a hurry.
void on_signal(int number) {
    stop_requested.store(true);
    std::signal(number, SIG_DFL);
}

}  // namespace

int main(int argc, char** argv) {
    using namespace surefoot;
    std::signal(SIGINT, on_signal);
    std::signal(SIGTERM, on_signal);
    std::signal(SIGPIPE, SIG_IGN);

    cli::Context context;
    context.stop = &stop_requested;
    context.terminal = isatty(STDERR_FILENO) == 1;
    context.colour = isatty(STDOUT_FILENO) == 1 && std::getenv("NO_COLOR") == nullptr;

    CLI::App app{
        "Surefoot walks through 3D models that are too complex to draw whole, every frame by its deadline.\n\n"
        "First steps:\n"
        "  surefoot scene forest --scale 10 -o forest.glb     a model and a path (or bring your own .glb, .gltf, .obj, .ostf)\n"
        "  surefoot bake forest.glb -o forest.walk            prepare it\n"
        "  surefoot calibrate                                 measure this machine, once\n"
        "  surefoot walk forest.walk --path forest.path.csv --report report",
        "surefoot"};
    app.require_subcommand(1);
    app.set_version_flag("--version", SUREFOOT_VERSION);
    cli::add_scene(app, context);
    cli::add_bake(app, context);
    cli::add_inspect(app, context);
    cli::add_effects(app, context);
    cli::add_calibrate(app, context);
    cli::add_walk(app, context);
    cli::add_accuracy(app, context);
    cli::add_replay(app, context);
    cli::add_devices(app, context);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? cli::exit_success : cli::exit_usage;
    }
    try {
        return context.run();
    } catch (const std::bad_alloc&) {
        return cli::fail({"memory", "not enough for this work", "close other programs, or bake on a machine with more"});
    } catch (const std::exception& error) {
        return cli::fail({"surefoot", std::string("unexpected: ") + error.what(), "please report this with the command line"});
    }
}
