// Raw reports with their times, in hid-recorder's text format, read and written bit for bit.
//
//   # a comment                        D: 0                     (the device that the next lines are of)
//   R: 3 05 01 c0                      the report descriptor: its length, then its bytes in hexadecimal
//   N: name     P: place               I: 3 046d c626           (bus, vendor, product, hexadecimal)
//   E: 000012.345678 7 01 00 ...       a report: seconds.microseconds, its length, its bytes, the id first if it has one
//
// Source: hid-tools, hid-recorder(1). Other lines of one letter and a colon are passed over, as hid-replay does.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "rt/base/result.hpp"

namespace surefoot::input {

constexpr std::size_t max_recorded_report_bytes = 16384;  ///< of one report; a descriptor likewise
constexpr std::size_t max_recording_bytes = 256U << 20U;  ///< of the file

/// One report of a recording. Its bytes are in Recording::bytes.
struct RecordedReport {
    std::int64_t time_us = 0;
    std::size_t first = 0, size = 0;  ///< in Recording::bytes
    std::uint32_t line = 0;           ///< in the file, from 1; 0 where it was not read from one
};

/// One device's recording.
struct Recording {
    std::vector<std::byte> descriptor;
    std::string name, place;
    std::uint16_t bus = 0, vendor = 0, product = 0;
    std::vector<RecordedReport> reports;
    std::vector<std::byte> bytes;     ///< of all reports
    std::uint32_t other_devices = 0;  ///< reports of other devices in the same file, passed over

    [[nodiscard]] std::span<const std::byte> report(std::size_t i) const {
        return std::span(bytes).subspan(reports[i].first, reports[i].size);
    }
    void add(std::int64_t time_us, std::span<const std::byte> report);
};

/// Parses the `text` of a recording. Errors name "`place`: line N". Reads the device of the first D: line, or the only one.
Result<Recording> parse_recording(std::string_view text, const std::string& place);
Result<Recording> read_recording(const std::string& file);

/// True where the bytes look like such a text, not like a binary descriptor.
bool looks_like_recording(std::span<const std::byte> bytes);

/// The head of a recording: everything but its reports.
std::string recording_head(const Recording& recording);
/// Appends one E: line. Times are written as hid-recorder does, in microseconds.
void append_report(std::string& text, std::int64_t time_us, std::span<const std::byte> report);
std::string write_recording(const Recording& recording);

}  // namespace surefoot::input
