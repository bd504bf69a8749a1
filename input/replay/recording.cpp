// The text of recordings, line by line; no line is trusted.
#include "input/replay/recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>

#include "rt/base/file.hpp"
#include "rt/base/text.hpp"

namespace surefoot::input {

namespace {

constexpr std::int64_t max_time_s = 1'000'000'000'000;  ///< 30 000 years: far from the end of 64 bits of microseconds

constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";  ///< of editors on other systems

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r'; }

/// Words of one line, from the left.
class Words {
public:
    explicit Words(std::string_view line) : left_(line) {}
    std::string_view next() {
        while (!left_.empty() && is_space(left_.front())) left_.remove_prefix(1);
        std::size_t n = 0;
        while (n < left_.size() && !is_space(left_[n])) ++n;
        const auto word = left_.substr(0, n);
        left_.remove_prefix(n);
        return word;
    }
    [[nodiscard]] std::string_view rest() {
        while (!left_.empty() && is_space(left_.front())) left_.remove_prefix(1);
        while (!left_.empty() && is_space(left_.back())) left_.remove_suffix(1);
        return left_;
    }

private:
    std::string_view left_;
};

/// "000012.345678": digits behind the sixth are cut off.
std::optional<std::int64_t> time_of(std::string_view word) {
    const auto dot = word.find('.');
    const auto seconds = number_in<std::uint64_t>(word.substr(0, dot), 10);
    if (!seconds || *seconds > static_cast<std::uint64_t>(max_time_s)) return std::nullopt;
    std::int64_t us = 0;
    if (dot != std::string_view::npos) {
        const auto digits = word.substr(dot + 1);
        if (digits.empty() || digits.size() > 9) return std::nullopt;
        for (std::size_t i = 0; i < std::max<std::size_t>(6, digits.size()); ++i) {
            const char c = i < digits.size() ? digits[i] : '0';
            if (c < '0' || c > '9') return std::nullopt;
            if (i < 6) us = us * 10 + (c - '0');
        }
    }
    return static_cast<std::int64_t>(*seconds) * 1'000'000 + us;
}

class RecordingParser {
public:
    RecordingParser(std::string_view text, const std::string& place) : text_(text), place_(place) {}

    Result<Recording> run() {
        if (text_.starts_with(byte_order_mark)) text_.remove_prefix(byte_order_mark.size());
        while (!text_.empty()) {
            const auto end = text_.find('\n');
            const auto line = text_.substr(0, end);
            text_.remove_prefix(end == std::string_view::npos ? text_.size() : end + 1);
            ++line_;
            if (auto wrong = read_line(line); !wrong) return wrong.error();
        }
        return std::move(recording_);
    }

private:
    [[nodiscard]] Error error(std::string what, std::string remedy) const {
        return {fmt::format("{}: line {}", place_, line_), std::move(what), std::move(remedy), ErrorKind::damaged};
    }

    Result<void> read_line(std::string_view line) {
        Words words(line);
        const auto head = words.next();
        if (head.empty() || head.front() == '#') return {};
        if (head.size() != 2 || head[1] != ':' || head[0] < 'A' || head[0] > 'Z') {
            return error("The line is not part of a recording", "Begin lines with R:, N:, P:, I:, E:, D: or #");
        }
        if (head[0] == 'D') return read_device(words);
        if (device_ != chosen_) {
            recording_.other_devices += head[0] == 'E';
            return {};
        }
        switch (head[0]) {
            case 'R':
                return read_descriptor_line(words);
            case 'N':
                recording_.name = words.rest();
                return {};
            case 'P':
                recording_.place = words.rest();
                return {};
            case 'I':
                return read_ids(words);
            case 'E':
                return read_report(words);
            default:
                return {};
        }
    }

    Result<void> read_device(Words& words) {
        const auto n = number_in<std::uint32_t>(words.next(), 10);
        if (!n) return error("A device line needs a number", "Write it as D: 0");
        device_ = *n;
        if (!chosen_named_) chosen_ = *n;
        chosen_named_ = true;
        return {};
    }

    Result<void> read_ids(Words& words) {
        const auto bus = number_in<std::uint16_t>(words.next(), 16), vendor = number_in<std::uint16_t>(words.next(), 16),
                   product = number_in<std::uint16_t>(words.next(), 16);
        if (!bus || !vendor || !product)
            return error("An id line needs bus, vendor and product in hexadecimal", "Write it as I: 3 046d c626");
        recording_.bus = *bus;
        recording_.vendor = *vendor;
        recording_.product = *product;
        return {};
    }

    /// "LENGTH byte byte ...", appended to `to`.
    Result<void> read_bytes(Words& words, std::vector<std::byte>& to) {
        const auto length = number_in<std::size_t>(words.next(), 10);
        if (!length || *length > max_recorded_report_bytes) {
            return error(fmt::format("A length of 0 to {} bytes must stand before the bytes", max_recorded_report_bytes),
                         "Write a report as E: 000000.000000 2 01 ff");
        }
        for (std::size_t i = 0; i < *length; ++i) {
            const auto word = words.next();
            if (word.empty())
                return error(fmt::format("The line announces {} bytes and has {}", *length, i),
                             "Check whether the file is cut off");
            const auto value = word.size() <= 2 ? number_in<std::uint8_t>(word, 16) : std::nullopt;
            if (!value)
                return error(fmt::format("The word '{}' is no byte in hexadecimal", word.substr(0, 16)),
                             "Write bytes as 00 to ff");
            to.push_back(static_cast<std::byte>(*value));
        }
        if (const auto rest = words.rest(); !rest.empty() && rest.front() != '#') {
            return error(fmt::format("The line announces {} bytes, but more follow", *length), "Correct the length");
        }
        return {};
    }

    Result<void> read_descriptor_line(Words& words) {
        if (!recording_.descriptor.empty())
            return error("The device has a second descriptor", "Put D: 1 before the lines of another device");
        return read_bytes(words, recording_.descriptor);
    }

    Result<void> read_report(Words& words) {
        const auto word = words.next();
        const auto time = time_of(word);
        if (!time)
            return error(fmt::format("The word '{}' is no time in seconds", word.substr(0, 32)),
                         "Write a report as E: 000012.345678 2 01 ff");
        RecordedReport report{*time, recording_.bytes.size(), 0, line_};
        if (auto read = read_bytes(words, recording_.bytes); !read) return read;
        report.size = recording_.bytes.size() - report.first;
        recording_.reports.push_back(report);
        return {};
    }

    std::string_view text_;
    const std::string& place_;
    Recording recording_;
    std::uint32_t line_ = 0, device_ = 0, chosen_ = 0;
    bool chosen_named_ = false;
};

void append_bytes(std::string& text, std::span<const std::byte> bytes) {
    fmt::format_to(std::back_inserter(text), "{}", bytes.size());
    for (const std::byte b : bytes) fmt::format_to(std::back_inserter(text), " {:02x}", std::to_integer<unsigned>(b));
    text += '\n';
}

}  // namespace

void Recording::add(std::int64_t time_us, std::span<const std::byte> report) {
    reports.push_back({time_us, bytes.size(), report.size(), 0});
    bytes.insert(bytes.end(), report.begin(), report.end());
}

Result<Recording> parse_recording(std::string_view text, const std::string& place) { return RecordingParser(text, place).run(); }

Result<Recording> read_recording(const std::string& file) {
    auto text = read_text(file, max_recording_bytes);
    if (!text) return text.error();
    return parse_recording(*text, file);
}

bool looks_like_recording(std::span<const std::byte> bytes) {
    const auto at = [&](std::size_t i) { return i < bytes.size() ? static_cast<char>(bytes[i]) : '\0'; };
    std::size_t i = 0;
    while (i < byte_order_mark.size() && at(i) == byte_order_mark[i]) ++i;
    if (i != byte_order_mark.size()) i = 0;
    while (is_space(at(i)) || at(i) == '\n') ++i;
    if (at(i) != '#' && !(at(i) >= 'A' && at(i) <= 'Z' && at(i + 1) == ':')) return false;
    return std::none_of(bytes.begin(), bytes.end(), [](std::byte b) {
        return std::to_integer<unsigned>(b) < 0x20 && b != std::byte{'\n'} && b != std::byte{'\r'} && b != std::byte{'\t'};
    });
}

std::string recording_head(const Recording& r) {
    // A name with a line break in it would be read back as something else.
    const auto one_line = [](std::string text) {
        std::replace_if(
            text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
        return text;
    };
    std::string text = "D: 0\nR: ";
    append_bytes(text, r.descriptor);
    text += fmt::format("N: {}\nP: {}\nI: {:x} {:04x} {:04x}\n", one_line(r.name), one_line(r.place), r.bus, r.vendor, r.product);
    return text;
}

void append_report(std::string& text, std::int64_t time_us, std::span<const std::byte> report) {
    const std::int64_t t = std::max<std::int64_t>(0, time_us);
    fmt::format_to(std::back_inserter(text), "E: {:06}.{:06} ", t / 1'000'000, t % 1'000'000);
    append_bytes(text, report);
}

std::string write_recording(const Recording& r) {
    std::string text = recording_head(r);
    for (std::size_t i = 0; i < r.reports.size(); ++i) append_report(text, r.reports[i].time_us, r.report(i));
    return text;
}

}  // namespace surefoot::input
