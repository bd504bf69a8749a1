// What every command shares: registration with CLI11, exit codes, progress on a terminal, one JSON object on stdout.
#pragma once

#include <CLI/CLI.hpp>
#include <atomic>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "rt/base/progress.hpp"
#include "rt/base/result.hpp"

namespace surefoot::cli {

/// Exit codes. They are a contract: scripts rely on them.
constexpr int exit_success = 0, exit_failure = 1, exit_usage = 2;
/// Ended early by Ctrl-C, SIGTERM or SIGHUP; the number is that of shells.
constexpr int exit_stopped = 130;

/// Handed to the commands: what to run after parsing, and the request to stop.
struct Context {
    std::function<int()> run;                 ///< set by the chosen command
    const std::atomic<bool>* stop = nullptr;  ///< set by SIGINT and SIGTERM
    bool terminal = false;                    ///< stderr is a terminal: progress and colour
    bool colour = false;                      ///< stdout is a terminal and NO_COLOR is not set
};

/// Options of this group are accepted, but not shown in --help.
constexpr const char* hidden_group = "Experiments";
/// Formats --help.
std::shared_ptr<CLI::Formatter> help_formatter();

/// A subcommand with its help, an example, and --json.
CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& what, const std::string& example, bool& json);

/// A bar with the time left on stderr; silent if stderr is not a terminal. `context` must outlive it.
Progress terminal_progress(const Context& context);
/// Clears the bar's line.
void end_progress(const Context& context);

/// Prints "surefoot: " and the error's text() on stderr; returns exit_failure.
int fail(const Error& error);
/// The same for wrong use; returns exit_usage.
int misuse(const Error& error);
void notify(const std::string& text);
/// JSON as valid UTF-8, even if names in it are not; indent -1: one line.
std::string json_text(const nlohmann::ordered_json& value, int indent);
void print_json(const nlohmann::ordered_json& object);
/// Flushes stdout. Returns `code`, or exit_failure if output is lost. Reports that on stderr, unless the reader of a pipe has
/// gone. error: of an earlier failed write, or 0.
int finish_output(int code, int error = 0);

void add_scene(CLI::App& app, Context& context);
void add_bake(CLI::App& app, Context& context);
void add_inspect(CLI::App& app, Context& context);
void add_effects(CLI::App& app, Context& context);
void add_calibrate(CLI::App& app, Context& context);
void add_walk(CLI::App& app, Context& context);
void add_soak(CLI::App& app, Context& context);
void add_accuracy(CLI::App& app, Context& context);
void add_compare(CLI::App& app, Context& context);
void add_replay(CLI::App& app, Context& context);
void add_devices(CLI::App& app, Context& context);
void add_doctor(CLI::App& app, Context& context);
void add_selftest(CLI::App& app, Context& context);
void add_cache_study(CLI::App& app, Context& context);
void add_config(CLI::App& app, Context& context);
void add_status(CLI::App& app, Context& context);
void add_top(CLI::App& app, Context& context);
/// `app` must outlive the run: the pages are made of all of it.
void add_manual(CLI::App& app, Context& context);

}  // namespace surefoot::cli
