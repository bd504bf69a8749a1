// Lines, objects, and the small things that every check needs.
#include "tests/vm/checks.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/eventually.hpp"

namespace surefoot::vm {

namespace {

std::string as_json(std::string_view text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') out += '\\';
        out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    }
    return out + '"';
}

}  // namespace

bool Checks::check(std::string_view name, bool passed, std::string_view detail) {
    if (!passed) ++failed_;
    write(name, passed ? "pass" : "FAIL", detail);
    return passed;
}

void Checks::not_run(std::string_view name, std::string_view why) { write(name, "not run", why); }

void Checks::write(std::string_view name, std::string_view verdict, std::string_view detail) {
    const std::string line = group_ + "." + std::string(name);
    std::printf("[ %-7s ] %-34s %.*s\n", std::string(verdict).c_str(), line.c_str(), static_cast<int>(detail.size()),
                detail.data());
    std::fflush(stdout);
    if (file_ == nullptr) return;
    const std::string object = "{\"check\": " + as_json(line) +
                               ", \"verdict\": " + as_json(verdict == "FAIL" ? "fail" : verdict) +
                               ", \"detail\": " + as_json(detail) + "}\n";
    std::fputs(object.c_str(), file_);
    std::fflush(file_);
}

std::int64_t now_ns() {
    timespec t{};
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec * std::int64_t{1'000'000'000} + t.tv_nsec;
}

void sleep_ms(double ms) {
    const auto ns = static_cast<std::int64_t>(ms * 1e6);
    const timespec t{ns / 1'000'000'000, ns % 1'000'000'000};
    nanosleep(&t, nullptr);
}

std::size_t open_descriptors() {
    const std::filesystem::directory_iterator all("/proc/self/fd");
    return static_cast<std::size_t>(std::distance(begin(all), end(all))) - 1;  // without the one that looks
}

bool put(const std::string& file, std::string_view text) {
    const int fd = ::open(file.c_str(), O_WRONLY | O_CLOEXEC);
    const bool written = fd >= 0 && ::write(fd, text.data(), text.size()) == static_cast<ssize_t>(text.size());
    if (!written) std::fprintf(stderr, "%s: cannot be written: %s\n", file.c_str(), std::strerror(errno));
    if (fd >= 0) ::close(fd);
    return written;
}

std::string get(const std::string& file) {
    std::ifstream in(file);
    std::string text{std::istreambuf_iterator<char>(in), {}};
    while (!text.empty() && text.back() == '\n') text.pop_back();
    return text;
}

bool wait_for_file(const std::string& file, int within_ms) {
    return test::eventually(within_ms * 1e-3, [&] { return std::filesystem::exists(file); });
}

}  // namespace surefoot::vm
