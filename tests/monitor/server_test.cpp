// The server against readers of every kind: what they get, what they cannot take, and where it listens.
#include <gtest/gtest.h>

#include <sys/resource.h>
#include <time.h>

#include <atomic>
#include <cstdlib>
#include <memory>
#include <thread>
#include <vector>

#include "rt/base/file.hpp"
#include "rt/clock/clock.hpp"
#include "tests/eventually.hpp"
#include "tests/monitor/http.hpp"
#include "tests/temporary_folder.hpp"
#include "tools/monitor/address.hpp"
#include "tools/monitor/server.hpp"

namespace surefoot::monitor {
namespace {

using test::eventually;
using test::RawReader;
using test::TemporaryFolder;

constexpr std::string_view hello_request = "GET /hello HTTP/1.1\r\nHost: localhost\r\n\r\n";

Server::Pages hello_pages(std::size_t bytes = 0) {
    auto body = std::make_shared<const std::string>(bytes == 0 ? std::string("hello\n") : std::string(bytes, 'x'));
    return [body](std::string_view path) -> std::optional<Server::Page> {
        if (path != "/hello") return std::nullopt;
        return Server::Page{"text/plain", body};
    };
}

Address at_socket(const TemporaryFolder& folder) { return *parse_address("unix:" + (folder / "s.sock")); }
Address any_port() { return *parse_address("127.0.0.1:0"); }

std::unique_ptr<Server> serving(const Address& address, Server::Pages pages, const ServerLimits& limits = {}) {
    auto server = Server::listen(address, std::move(pages), limits);
    EXPECT_TRUE(server.ok()) << (server.ok() ? "" : server.error().text());
    return server.ok() ? std::move(*server) : nullptr;
}

std::int64_t process_cpu_ns() {
    timespec t{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return t.tv_sec * 1'000'000'000LL + t.tv_nsec;
}

TEST(Address, IsASocketOrAPortOnLoopback) {
    EXPECT_EQ(parse_address("unix:/run/x.sock")->socket_path, "/run/x.sock");
    EXPECT_EQ(parse_address("/run/x.sock")->text(), "unix:/run/x.sock");
    EXPECT_EQ(parse_address("127.0.0.1:9464")->port, 9464);
    EXPECT_EQ(parse_address("localhost:1")->text(), "127.0.0.1:1");
    EXPECT_EQ(parse_address("[::1]:9464")->text(), "[::1]:9464");
    for (const char* bad : {"", "9464", "127.0.0.1:", "127.0.0.1:99999", "127.0.0.1:-1", "127.0.0.1:80x", "unix:", "host:80"})
        EXPECT_FALSE(parse_address(bad).ok()) << bad;
    for (const char* open : {"0.0.0.0:80", "192.168.1.2:80", "[::]:80", "128.0.0.1:80"}) {
        ASSERT_FALSE(parse_address(open).ok()) << open;
        EXPECT_NE(parse_address(open).error().what.find("loopback"), std::string::npos) << open;
    }
    EXPECT_NE(parse_address("/" + std::string(200, 'x')).error().what.find("too long"), std::string::npos);
}

TEST(Address, TheDefaultIsInTheRuntimeDirectory) {
    ::setenv("RUNTIME_DIRECTORY", "/run/one:/run/two", 1);
    EXPECT_EQ(default_address(), "unix:/run/one/surefoot.sock");
    ::unsetenv("RUNTIME_DIRECTORY");
    EXPECT_EQ(default_address(), "unix:/run/surefoot/surefoot.sock");
}

TEST(Server, ServesOnASocketAndOnAPort) {
    const TemporaryFolder folder;
    for (const Address& address : {at_socket(folder), any_port(), *parse_address("[::1]:0")}) {
        auto server = Server::listen(address, hello_pages());
        if (!server && address.host == "::1") continue;  // a machine without IPv6
        ASSERT_TRUE(server.ok()) << server.error().text();
        const auto got = fetch((*server)->address(), "/hello");
        ASSERT_TRUE(got.ok()) << got.error().text();
        EXPECT_EQ(*got, "hello\n");
        EXPECT_FALSE(fetch((*server)->address(), "/other").ok());
        EXPECT_EQ((*server)->counts().answered, 1U);
        EXPECT_EQ((*server)->counts().refused, 1U);
    }
    EXPECT_FALSE(std::filesystem::exists(folder / "s.sock")) << "its socket goes with it";
}

TEST(Server, AnswersEveryRequest) {
    const auto server = serving(any_port(), hello_pages());
    const auto answer_to = [&](std::string_view request) {
        RawReader r(server->address());
        EXPECT_TRUE(r.send_text(request));
        const std::string answer = r.listen();
        return answer.substr(0, answer.find("\r\n"));
    };
    EXPECT_EQ(answer_to(hello_request), "HTTP/1.1 200 OK");
    EXPECT_EQ(answer_to("GET /hello?format=text HTTP/1.0\r\n\r\n"), "HTTP/1.1 200 OK");
    EXPECT_EQ(answer_to("HEAD /hello HTTP/1.1\r\nHost: localhost\r\n\r\n"), "HTTP/1.1 200 OK");
    EXPECT_EQ(answer_to("POST /hello HTTP/1.1\r\n\r\n"), "HTTP/1.1 405 Method Not Allowed");
    EXPECT_EQ(answer_to("GET /../etc/passwd HTTP/1.1\r\nHost: localhost\r\n\r\n"), "HTTP/1.1 404 Not Found");
    for (const char* nonsense :
         {"\r\n\r\n", "GET\r\n\r\n", "GET /hello\r\n\r\n", "\x16\x03\x01\x02\r\n\r\n", "GET /hello SPDY/3\r\n\r\n"})
        EXPECT_EQ(answer_to(nonsense), "HTTP/1.1 400 Bad Request") << nonsense;
    EXPECT_EQ(answer_to("GET /hello HTTP/1.1\r\nX: " + std::string(4200, 'x')), "HTTP/1.1 431 Request Header Fields Too Large");
}

// DNS rebinding: a page of another site reads what a browser on this machine can reach, under a name of its own.
TEST(Server, APortAnswersOnlyRequestsThatNameThisMachine) {
    const auto server = serving(any_port(), hello_pages());
    const auto answer_to = [&](const std::string& head) {
        RawReader r(server->address());
        EXPECT_TRUE(r.send_text("GET /hello " + head + "\r\n\r\n"));
        const std::string answer = r.listen();
        EXPECT_EQ(answer.find("hello\n") != std::string::npos, answer.starts_with("HTTP/1.1 200")) << head;
        return answer.substr(9, 3);
    };
    const std::string port = std::to_string(server->address().port);
    for (const std::string& own : {std::string("localhost"), "localhost:" + port, std::string("LocalHost"), "127.0.0.1:" + port,
                                   std::string("127.0.0.1"), std::string("[::1]"), "[::1]:" + port})
        EXPECT_EQ(answer_to("HTTP/1.1\r\nAccept: */*\r\nhOST: \t" + own + " "), "200") << own;
    for (const std::string& foreign :
         {std::string("attacker.example"), "attacker.example:" + port, std::string("localhost.attacker.example"),
          std::string("127.0.0.1.attacker.example"), std::string("localhost:80:80"), std::string("localhost:80@x"),
          std::string("192.168.1.2"), std::string("[::2]"), std::string("[::1].attacker.example"), std::string("::1"),
          std::string("")})
        EXPECT_EQ(answer_to("HTTP/1.1\r\nHost: " + foreign), "421") << foreign;
    EXPECT_EQ(answer_to("HTTP/1.0\r\nHost: attacker.example"), "421");
    EXPECT_EQ(answer_to("HTTP/1.1"), "400") << "HTTP/1.1 asks for a Host";
    EXPECT_EQ(answer_to("HTTP/1.1\r\nX: localhost"), "400");
    EXPECT_EQ(answer_to("HTTP/1.1\r\nHost: localhost\r\nHost: attacker.example"), "400") << "which of the two?";
    EXPECT_EQ(answer_to("HTTP/1.0"), "200") << "HTTP/1.0 does not ask for it, and no browser speaks it";
}

TEST(Server, ASocketNeedsNoHost) {
    const TemporaryFolder folder;
    const auto server = serving(at_socket(folder), hello_pages());
    RawReader r(server->address());
    EXPECT_TRUE(r.send_text("GET /hello HTTP/1.1\r\nHost: attacker.example\r\n\r\n"));
    EXPECT_TRUE(r.listen().starts_with("HTTP/1.1 200 OK")) << "no browser opens a Unix socket";
}

TEST(Server, ARequestMayComeInPieces) {
    const auto server = serving(any_port(), hello_pages());
    RawReader r(server->address());
    for (const char& c : hello_request) ASSERT_TRUE(r.send_text(std::string_view(&c, 1)));
    EXPECT_NE(r.listen().find("hello"), std::string::npos);
}

// The server is held in one answer while others connect. It takes them all in at once then.
TEST(Server, AReaderIsCountedAsOpenBeforeItsAnswerIsMade) {
    std::atomic<const Server*> listening{nullptr};
    std::atomic<bool> held{false}, released{false};
    std::atomic<std::uint64_t> open_at_answer{0};
    const auto server = serving(any_port(), [&](std::string_view path) {
        if (path == "/hold") {
            held = true;
            EXPECT_TRUE(eventually(5, [&] { return released.load(); }));
        } else {
            open_at_answer = listening.load()->counts().open;
        }
        return hello_pages()("/hello");
    });
    listening = server.get();
    std::thread first([&] { EXPECT_EQ(*fetch(server->address(), "/hold"), "hello\n"); });
    EXPECT_TRUE(eventually(5, [&] { return held.load(); }));
    std::vector<RawReader> idle;
    for (int i = 0; i < 3; ++i) idle.emplace_back(server->address());
    RawReader last(server->address());
    EXPECT_TRUE(last.send_text(hello_request));
    released = true;
    EXPECT_NE(last.listen().find("hello"), std::string::npos);
    first.join();
    EXPECT_EQ(open_at_answer, 4U);
}

TEST(Server, HalfOpenReadersAreGivenUpAndTheOthersServed) {
    ServerLimits limits;
    limits.readers = 8;
    limits.request_ms = 1000;
    const auto server = serving(any_port(), hello_pages(), limits);
    std::vector<RawReader> idle;
    for (int i = 0; i < 8; ++i) idle.emplace_back(server->address());
    idle[3].send_text("GET /he");
    for (int i = 0; i < 10; ++i) EXPECT_EQ(*fetch(server->address(), "/hello"), "hello\n") << "one more always gets in";
    EXPECT_TRUE(eventually(5, [&] { return server->counts().open == 0; })) << "silence is given up";
    EXPECT_EQ(server->counts().dropped_slow + server->counts().dropped_full, 8U);
    EXPECT_EQ(idle.back().listen(), "") << "and told so by closing";
}

TEST(Server, AReaderThatStopsReadingHoldsNobodyUp) {
    ServerLimits limits;
    limits.answer_ms = 500;
    constexpr std::size_t large = 12U << 20U;  // more than a socket takes in, less than a client takes
    const auto server = serving(any_port(), hello_pages(large), limits);
    std::vector<RawReader> stopped;
    for (int i = 0; i < 5; ++i) {
        stopped.emplace_back(server->address(), 4096);
        ASSERT_TRUE(stopped.back().send_text(hello_request));
    }
    RawReader head(server->address());
    ASSERT_TRUE(head.send_text("HEAD /hello HTTP/1.1\r\nHost: localhost\r\n\r\n"));
    EXPECT_TRUE(head.listen().starts_with("HTTP/1.1 200 OK"));
    EXPECT_TRUE(eventually(5, [&] { return server->counts().dropped_slow == 5; })) << server->counts().dropped_slow;
}

TEST(Server, AFloodIsTurnedAwayAtItsRate) {
    ServerLimits limits;
    limits.accepts_per_s = 50;
    const TemporaryFolder folder;
    const auto server = serving(at_socket(folder), hello_pages(), limits);
    std::vector<std::thread> flood;
    const std::int64_t begun_ns = rt::monotonic_ns();
    for (int i = 0; i < 4; ++i)
        flood.emplace_back([&] {
            while (rt::monotonic_ns() < begun_ns + 1'000'000'000) {
                RawReader r(server->address());
                r.send_text(hello_request);
                (void)r.listen(50);
            }
        });
    for (std::thread& t : flood) t.join();
    const std::uint64_t answered = server->counts().answered;
    const double seconds = static_cast<double>(rt::monotonic_ns() - begun_ns) * 1e-9;
    EXPECT_LE(static_cast<double>(answered), 50 + 50 * (seconds + 0.1)) << "a second's worth to begin with, and the rate after";
    EXPECT_GE(answered, 20U);
}

TEST(Server, WithoutDescriptorsItWaitsAndComesBack) {
#ifdef SUREFOOT_SANITIZED
    GTEST_SKIP()
        << "UBSan looks whether memory can be read through a pipe, and reports a false type where no descriptor is left for it";
#endif
    const TemporaryFolder folder;
    const auto server = serving(at_socket(folder), hello_pages());
    rlimit before{};
    getrlimit(RLIMIT_NOFILE, &before);
    const int next = ::dup(STDERR_FILENO);
    ::close(next);
    rlimit tight = before;
    tight.rlim_cur = static_cast<rlim_t>(next) + 1;
    setrlimit(RLIMIT_NOFILE, &tight);
    RawReader late(server->address());  // takes the last one: none is left to accept it with
    EXPECT_TRUE(late.connected());
    const std::int64_t cpu_before = process_cpu_ns();
    EXPECT_FALSE(eventually(0.6, [&] { return process_cpu_ns() - cpu_before >= 200'000'000; })) << "it spins";
    setrlimit(RLIMIT_NOFILE, &before);
    EXPECT_TRUE(late.send_text(hello_request));
    EXPECT_NE(late.listen().find("hello"), std::string::npos);
}

TEST(Server, TakesADeadSocketsPlaceAndNobodyElses) {
    const TemporaryFolder folder;
    const Address address = at_socket(folder);
    {
        // As a killed process leaves it: bound, and nobody listens.
        const SocketAddress at = socket_address(address);
        const int fd = ::socket(AF_UNIX, SOCK_STREAM, 0);
        ASSERT_EQ(::bind(fd, at.get(), at.length), 0);
        ::close(fd);
    }
    const auto server = serving(address, hello_pages());
    ASSERT_NE(server, nullptr);
    EXPECT_EQ(*fetch(address, "/hello"), "hello\n");
    const auto second = Server::listen(address, hello_pages());
    ASSERT_FALSE(second.ok());
    EXPECT_NE(second.error().text().find(address.text()), std::string::npos);
    EXPECT_NE(second.error().text().find("in use"), std::string::npos);
    EXPECT_EQ(*fetch(address, "/hello"), "hello\n") << "the first is still there";
    ASSERT_TRUE(write_text(folder / "plain", "kept").ok());
    EXPECT_FALSE(Server::listen(*parse_address(folder / "plain"), hello_pages()).ok());
    EXPECT_EQ(*read_text(folder / "plain"), "kept");
    const auto nowhere = Server::listen(*parse_address("/nonexistent/s.sock"), hello_pages());
    ASSERT_FALSE(nowhere.ok());
    EXPECT_FALSE(nowhere.error().remedy.empty());
    const auto port = serving(any_port(), hello_pages());
    const auto taken = Server::listen(port->address(), hello_pages());
    ASSERT_FALSE(taken.ok());
    EXPECT_NE(taken.error().text().find(port->address().text()), std::string::npos);
}

TEST(Client, NamesThePlaceAndTheRemedy) {
    const TemporaryFolder folder;
    const auto nobody = fetch(at_socket(folder), "/hello");
    ASSERT_FALSE(nobody.ok());
    EXPECT_NE(nobody.error().place.find("s.sock"), std::string::npos);
    EXPECT_NE(nobody.error().remedy.find("surefootd"), std::string::npos);
    // Somebody who listens and never answers.
    const Address address = at_socket(folder);
    const SocketAddress at = socket_address(address);
    const int fd = ::socket(AF_UNIX, SOCK_STREAM, 0);
    ASSERT_EQ(::bind(fd, at.get(), at.length), 0);
    ASSERT_EQ(::listen(fd, 1), 0);
    const auto mute = fetch(address, "/hello", 200);
    ASSERT_FALSE(mute.ok());
    EXPECT_NE(mute.error().what.find("does not answer"), std::string::npos);
    ::close(fd);
}

}  // namespace
}  // namespace surefoot::monitor
