// surefoot status and surefoot top: what a running service says of itself, once or every second.
#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <ctime>
#include <memory>
#include <optional>

#include "rt/clock/clock.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/options.hpp"
#include "tools/cli/screen.hpp"
#include "tools/monitor/address.hpp"
#include "tools/monitor/view.hpp"
#include "tools/report/terminal.hpp"

namespace surefoot::cli {

namespace {

using nlohmann::json;

struct LookArguments {
    std::string socket;
    double seconds = 0, every_s = 1;
    bool json = false;
};

struct Reply {
    std::string text;
    json status;
};

Result<Reply> fetch(const monitor::Address& address) {
    auto text = monitor::fetch(address, "/status.json");
    if (!text) return text.error();
    auto status = monitor::parse_status(address, *text);
    if (!status) return status.error();
    return Reply{std::move(*text), std::move(*status)};
}

Result<monitor::Address> place_of(const LookArguments& a) {
    return monitor::parse_address(a.socket.empty() ? monitor::default_address() : a.socket);
}

int run_status(const LookArguments& a, const Context& context) {
    const auto address = place_of(a);
    if (!address) return misuse(address.error());
    const auto reply = fetch(*address);
    if (!reply) return fail(reply.error());
    if (a.json) {
        print_json(nlohmann::ordered_json::parse(reply->text));
        return exit_success;
    }
    for (const std::string& line : monitor::status_page(reply->status, report::terminal_style(context.colour)))
        fmt::print("{}\n", line);
    return exit_success;
}

/// Every second until the end; what is shown where stdout is a terminal, a pipe, or wants JSON.
class Top {
public:
    Top(const LookArguments& a, const Context& context, const monitor::Address& address)
        : a_(a), context_(context), address_(address), screen_wanted_(!a.json && isatty(STDOUT_FILENO) == 1) {}

    int run() {
        // The first answer decides whether there is anything to look at; later, a service may come and go.
        auto first = fetch(address_);
        if (!first) return fail(first.error());
        if (screen_wanted_) screen_.emplace();
        const std::int64_t every_ns = static_cast<std::int64_t>(a_.every_s * 1e9), start_ns = rt::monotonic_ns();
        std::int64_t due_ns = start_ns;
        bool going = show(std::move(first));
        while (going && !context_.stop->load() &&
               (a_.seconds <= 0 || rt::monotonic_ns() - start_ns < static_cast<std::int64_t>(a_.seconds * 1e9))) {
            due_ns += every_ns;
            if (!wait_until(due_ns)) break;
            due_ns = std::max(due_ns, rt::monotonic_ns() - every_ns);
            going = show(fetch(address_));
        }
        screen_.reset();
        return going ? exit_success : exit_failure;
    }

private:
    /// False: the user wants to end.
    bool wait_until(std::int64_t due_ns) {
        while (!context_.stop->load()) {
            const std::int64_t left_ms = (due_ns - rt::monotonic_ns()) / 1'000'000;
            if (left_ms <= 0) return true;
            if (!screen_) {
                timespec part{0, static_cast<long>(std::min<std::int64_t>(left_ms, 200)) * 1'000'000};
                (void)nanosleep(&part, nullptr);
                continue;
            }
            const char key = screen_->wait_key(left_ms);
            if (key == 'q' || key == 'Q' || key == 3 || key == 4) return false;
            if (key != 0) draw();  // any other key: a fresh screen
        }
        return false;
    }
    /// False: nobody reads what is printed.
    bool show(Result<Reply> reply) {
        const std::int64_t now_ns = rt::monotonic_ns();
        trouble_ = reply ? std::string() : reply.error().text();
        if (!reply) {
            if (!screen_) notify(trouble_);
            if (screen_) draw();
            return true;
        }
        before_ = std::exchange(status_, std::move(reply->status));
        between_s_ = before_.is_null() ? 0 : static_cast<double>(now_ns - shown_ns_) * 1e-9;
        shown_ns_ = now_ns;
        if (screen_) {
            draw();
            return true;
        }
        const std::string line =
            a_.json ? reply->text : time_of_day() + " " + monitor::top_line(status_, before_, between_s_) + "\n";
        return std::fputs(line.c_str(), stdout) >= 0 && std::fflush(stdout) == 0;
    }
    void draw() {
        const report::TerminalStyle style = report::terminal_style(context_.colour);
        std::vector<std::string> lines = monitor::top_page(status_, before_, between_s_, style);
        if (!trouble_.empty() && !lines.empty())
            lines.back() = report::cut_to("the service does not answer, trying again: " + trouble_, style.width);
        screen_->draw(lines);
    }
    static std::string time_of_day() {
        const std::time_t now = std::time(nullptr);
        std::tm local{};
        localtime_r(&now, &local);
        return fmt::format("{:02}:{:02}:{:02}", local.tm_hour, local.tm_min, local.tm_sec);
    }

    const LookArguments& a_;
    const Context& context_;
    const monitor::Address& address_;
    bool screen_wanted_;
    std::optional<FullScreen> screen_;
    json status_, before_;
    double between_s_ = 0;
    std::int64_t shown_ns_ = 0;
    std::string trouble_;
};

void add_place(CLI::App* c, const std::shared_ptr<LookArguments>& a) {
    c->add_option(
        "--socket", a->socket,
        "Address of the monitor: unix:PATH or 127.0.0.1:PORT [surefoot.sock in $RUNTIME_DIRECTORY, else in /run/surefoot]");
}

}  // namespace

void add_status(CLI::App& app, Context& context) {
    auto a = std::make_shared<LookArguments>();
    CLI::App* c = add_command(app, "status", "Show the state of a running service, on one page",
                              "surefoot status\n  surefoot status --socket 127.0.0.1:9464 --json", a->json);
    add_place(c, a);
    c->callback([&context, a] { context.run = [&context, a] { return run_status(*a, context); }; });
}

void add_top(CLI::App& app, Context& context) {
    auto a = std::make_shared<LookArguments>();
    CLI::App* c = add_command(app, "top", "Show a running service live: frame times, slack, misses by cause, devices, threads",
                              "surefoot top\n  surefoot top --socket 127.0.0.1:9464 --seconds 60 > lines.txt", a->json);
    add_place(c, a);
    c->add_option("--every", a->every_s, "Seconds between updates [1]")->check(number_within(0.2, 3600, "s"));
    c->add_option("--seconds", a->seconds, "Seconds after which the command ends")->check(number_within(0.2, 1e9, "s"));
    c->callback([&context, a] {
        context.run = [&context, a] {
            const auto address = place_of(*a);
            if (!address) return misuse(address.error());
            return Top(*a, context, *address).run();
        };
    });
}

}  // namespace surefoot::cli
