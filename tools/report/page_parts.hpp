// Parts of the walk's page that are words, figures and pictures rather than charts; and a picture as a data URI.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "tools/report/report.hpp"

namespace surefoot::report {

/// Brand, verdict and what was walked.
std::string page_header(const WalkSummary& summary);
/// What is not real-time here, and how to grant it; empty where nothing lacks.
std::string degraded_notes(const WalkSummary& summary);
/// The six figures that matter.
std::string tiles(const WalkSummary& summary);
/// Pictures along the path, each with its top view; empty without snapshots. time_s: one a snapshot.
std::string snapshot_cards(const WalkSummary& summary, std::span<const double> time_s, std::span<const ReportSnapshot> snapshots);
/// The forms that cost the pictures most, each beside full detail; empty without any.
std::string worst_form_cards(const WalkSummary& summary);
/// All percentiles, for who wants them.
std::string figures_table(const WalkSummary& summary);
std::string machine_table(const WalkSummary& summary);
std::string page_footer();

/// A JPEG of quality 1..100 as "data:image/jpeg;base64,…"; empty where the picture is empty or its size does not fit.
std::string jpeg_data_uri(std::span<const std::uint8_t> rgba, std::uint32_t width, std::uint32_t height, int quality);
std::string base64(std::span<const std::uint8_t> bytes);

}  // namespace surefoot::report
