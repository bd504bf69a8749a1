// The verdict on the figures, in sentences: shared by the terminal's table and the page.
#pragma once

#include <string>

#include "tools/report/report.hpp"

namespace surefoot::report {

enum class Verdict { good, warn, bad };

/// good: nothing missed; warn: misses, but within the deadline rule (at most 2 own misses per 1800 frames);
/// bad: beyond it, or nothing ran.
Verdict verdict_of(const WalkSummary& summary);
/// A control ran, and the walk had too many own misses, or more misses than the control.
bool rule_broken(const ControlSummary& control);
/// "1800 frames, 0 missed: the slowest took 31.2 of 33.3 ms."
std::string headline(const WalkSummary& summary);
/// The verdict of the control in words; empty where no control ran.
std::string control_words(const ControlSummary& control);
/// ", off axis by 0.5 halves right, 0 up,"; empty for a symmetric projection.
std::string off_axis_words(const WalkSummary& summary);
/// The seat and what the eye tells apart; empty where neither is given.
std::string seat_words(const WalkSummary& summary);
/// The device, its latency, and its stops; empty if a path was followed.
std::string input_words(const InputSummary& input);
/// "sf-frame fifo 80 on 1; 2 llvmpipe- fifo 70 on 0-1".
std::string threads_words(std::span<const rt::CensusRow> threads);
/// The largest angular error of an accuracy: "0.24°", "3.1′"; "exact" where no error was drawn.
std::string accuracy_words(double accuracy);
/// Pictures against full detail; some must have been compared.
std::string picture_words(const PictureSummary& picture);
/// "14.2 dB", "∞ dB" for equal pictures, "undefined" where there is no signal.
std::string decibels(double db);
/// "2.5 %" of a share.
std::string percent(double share);

}  // namespace surefoot::report
