// What every command shares: registration, progress, errors, JSON.
#include "tools/cli/command.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <memory>

namespace surefoot::cli {

namespace {

/// One stage's bar: when it began, and when it was last drawn.
struct BarState {
    std::string stage;
    std::chrono::steady_clock::time_point begun, drawn;
};

void draw_bar(BarState& bar, std::string_view stage, double done) {
    const auto now = std::chrono::steady_clock::now();
    if (bar.stage != stage) {
        bar.stage = std::string(stage);
        bar.begun = now;
        bar.drawn = {};
    }
    if (now - bar.drawn < std::chrono::milliseconds(100) && done < 1.0) return;
    bar.drawn = now;
    const double spent = std::chrono::duration<double>(now - bar.begun).count();
    const int filled = static_cast<int>(std::clamp(done, 0.0, 1.0) * 24.0);
    std::string left;
    if (done > 0.02 && spent > 0.5) left = fmt::format("{:.0f} s left", spent / done * (1.0 - done));
    fmt::print(stderr, "\r\033[K{:<22} [{:<24}] {:3.0f} %  {}", bar.stage, std::string(static_cast<std::size_t>(filled), '#'),
               100.0 * done, left);
    std::fflush(stderr);
}

}  // namespace

CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& what, const std::string& example, bool& json) {
    CLI::App* command = app.add_subcommand(name, what);
    command->footer("Example:\n  " + example);
    command->add_flag("--json", json, "One JSON object on stdout; everything else on stderr");
    return command;
}

Progress terminal_progress(const Context& context) {
    Progress progress;
    progress.stop = context.stop;
    if (context.terminal) {
        auto bar = std::make_shared<BarState>();
        progress.report = [bar](std::string_view stage, double done) { draw_bar(*bar, stage, done); };
    }
    return progress;
}

void end_progress(const Context& context) {
    if (context.terminal) fmt::print(stderr, "\r\033[K");
}

int fail(const Error& error) {
    fmt::print(stderr, "surefoot: {}\n", error.text());
    return exit_failure;
}

void note(const std::string& text) { fmt::print(stderr, "surefoot: {}\n", text); }

void print_json(const nlohmann::ordered_json& object) { fmt::print("{}\n", object.dump(2)); }

}  // namespace surefoot::cli
