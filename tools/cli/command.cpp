// What every command shares: registration, progress, errors, JSON.
#include "tools/cli/command.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <memory>

#include "tools/report/terminal.hpp"

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
    std::string left;
    if (done > 0.02 && spent > 0.5) left = fmt::format("{:.0f} s left", spent / done * (1.0 - done));
    const std::string line = fmt::format("{}{}", report::clear_line, report::progress_line(bar.stage, done, left));
    (void)std::fputs(line.c_str(), stderr);
    std::fflush(stderr);
}

/// CLI11's own way to hide an option takes its name out of error messages too.
class HelpFormatter final : public CLI::Formatter {
public:
    [[nodiscard]] std::string make_group(std::string group, bool is_positional,
                                         std::vector<const CLI::Option*> options) const override {
        if (group == hidden_group) return {};
        return CLI::Formatter::make_group(std::move(group), is_positional, std::move(options));
    }
};

}  // namespace

std::shared_ptr<CLI::Formatter> help_formatter() { return std::make_shared<HelpFormatter>(); }

CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& what, const std::string& example, bool& json) {
    CLI::App* command = app.add_subcommand(name, what);
    command->footer("Example:\n  " + example);
    command->add_flag("--json", json, "Print one JSON object on stdout, and everything else on stderr");
    return command;
}

Progress terminal_progress(const Context& context) {
    Progress progress;
    progress.stop = context.stop;
    progress.notify = [terminal = context.terminal](std::string_view text) {
        if (terminal) (void)std::fputs(report::clear_line, stderr);
        notify(std::string(text));
    };
    if (context.terminal) {
        auto bar = std::make_shared<BarState>();
        progress.report = [bar](std::string_view stage, double done) { draw_bar(*bar, stage, done); };
    }
    return progress;
}

void end_progress(const Context& context) {
    if (context.terminal) (void)std::fputs(report::clear_line, stderr);
}

int fail(const Error& error) {
    notify(error.text());
    return exit_failure;
}

int misuse(const Error& error) {
    notify(error.text());
    return exit_usage;
}

// Not fmt::print: it throws where nothing can be written, and of that nobody could be told.
void notify(const std::string& text) { (void)std::fputs(("surefoot: " + text + "\n").c_str(), stderr); }

// Names come from files, and a file's name may hold any byte: what is no UTF-8 is replaced.
std::string json_text(const nlohmann::ordered_json& value, int indent) {
    return value.dump(indent, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

void print_json(const nlohmann::ordered_json& object) { fmt::print("{}\n", json_text(object, 2)); }

int finish_output(int code, int error) {
    errno = 0;
    const bool flushed = std::fflush(stdout) == 0;
    if (error == 0) error = errno;
    if (flushed && std::ferror(stdout) == 0) return code;
    if (error != EPIPE) {
        fail({"standard output",
              fmt::format("The output cannot be written: {}", error != 0 ? std::strerror(error) : "a part of it is lost"),
              "Free some space, or send the output elsewhere", ErrorKind::unwritable});
    }
    return code == exit_success ? exit_failure : code;
}

}  // namespace surefoot::cli
