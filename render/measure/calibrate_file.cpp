// The cost table as a file: TOML whose first line holds a checksum of the rest; and what machine it is valid for.
#include <fmt/format.h>

#include <toml++/toml.h>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string_view>
#include <thread>

#include "render/measure/calibrate.hpp"
#include "rt/base/file.hpp"
#include "rt/base/hash.hpp"

namespace surefoot::measure {

namespace {

constexpr std::string_view hash_key = "hash = \"";
constexpr std::uint32_t most_steps = 32;
constexpr int format_version = 1;
constexpr int estimate = 2;  // what is counted: 1 by boxes and whole representations, at a median; 2 as model::ItemCosts does
const char* const remedy = "Run `surefoot calibrate` on this machine";

std::string hash_text(std::string_view body) {
    return fmt::format("{:016x}", hash_bytes(std::as_bytes(std::span<const char>(body))));
}

void add_numbers(std::string& text, std::string_view key, const model::CostGrid& grid, float model::ItemCost::*member) {
    text += fmt::format("{} = [", key);
    for (std::size_t i = 0; i < grid.cells.size(); ++i) {
        text += i % grid.pixel_steps == 0 ? "\n  " : " ";
        text += fmt::format("{:.9g},", static_cast<double>(grid.cells[i].*member));
    }
    text += "\n]\n";
}

std::string quoted(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') out += '\\';
        out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    }
    return out + "\"";
}

std::string body_of(const model::CostModel& costs) {
    const model::FrameCombine& c = costs.combine;
    std::string text = fmt::format(
        "version = {}\nestimate = {}\nmachine = {}\ncalibrated = {}\ntimer_query_honest = {}\nupper_factor = {:.9g}\nslice_us = "
        "{:.9g}\n\n"
        "# frame_us = fixed_us + submit_weight * S + raster_weight * R + max_weight * max(S, R)\n[combine]\n"
        "fixed_us = {:.9g}\nsubmit_weight = {:.9g}\nraster_weight = {:.9g}\nmax_weight = {:.9g}\n",
        format_version, estimate, quoted(costs.machine), costs.calibrated, costs.timer_query_honest,
        static_cast<double>(costs.upper_factor), static_cast<double>(costs.slice_us), static_cast<double>(c.fixed_us),
        static_cast<double>(c.submit_weight), static_cast<double>(c.raster_weight), static_cast<double>(c.max_weight));
    for (const model::CostGrid& grid : costs.grids) {
        text += fmt::format(
            "\n# us an item; rows: 2^0, 2^1, ... triangles; columns: 2^0, 2^1, ... pixels\n[[class]]\neffects = {}\n"
            "triangle_steps = {}\npixel_steps = {}\n",
            grid.effects, grid.triangle_steps, grid.pixel_steps);
        add_numbers(text, "submit_us", grid, &model::ItemCost::submit_us);
        add_numbers(text, "raster_us", grid, &model::ItemCost::raster_us);
    }
    return text;
}

/// Reads numbers and remembers the first one that is missing or out of range.
class Values {
public:
    explicit Values(const toml::table& table) : table_(table) {}
    float number(std::string_view key, double low, double high) {
        const auto value = table_[key].value<double>();
        if (value && std::isfinite(*value) && *value >= low && *value <= high) return static_cast<float>(*value);
        complain(key);
        return 0;
    }
    std::uint32_t count(std::string_view key, std::uint32_t high) {
        const auto value = table_[key].value<std::int64_t>();
        if (value && *value >= 0 && *value <= static_cast<std::int64_t>(high)) return static_cast<std::uint32_t>(*value);
        complain(key);
        return 0;
    }
    void numbers(std::string_view key, model::CostGrid& grid, float model::ItemCost::*member) {
        const toml::array* list = table_[key].as_array();
        if (list == nullptr || list->size() != grid.cells.size()) return complain(key);
        for (std::size_t i = 0; i < grid.cells.size(); ++i) {
            const auto value = (*list)[i].value<double>();
            if (!value || !std::isfinite(*value) || *value < 0) return complain(key);
            grid.cells[i].*member = static_cast<float>(*value);
        }
    }
    void complain(std::string_view key) {
        if (wrong.empty()) wrong = key;
    }
    std::string wrong;

private:
    const toml::table& table_;
};

Result<model::CostModel> costs_of(const toml::table& table, const std::string& file) {
    model::CostModel costs;
    const auto refuse = [&](const std::string& key) {
        return Error{file, "The key '" + key + "' is missing or out of range", remedy, ErrorKind::damaged};
    };
    Values top(table);
    if (top.count("version", 1000) != format_version) return refuse("version");
    costs.machine = table["machine"].value_or(std::string());
    // Then no machine's own: walks say so, and what to do.
    if (table["estimate"].value_or(1) != estimate) costs.machine += ", by another version of the estimate";
    costs.calibrated = table["calibrated"].value_or(false);
    costs.timer_query_honest = table["timer_query_honest"].value_or(false);
    costs.upper_factor = top.number("upper_factor", 0.1, 100);
    costs.slice_us = top.number("slice_us", 0, 1e6);
    if (!top.wrong.empty()) return refuse(top.wrong);
    const toml::table* combine = table["combine"].as_table();
    if (combine == nullptr) return refuse("combine");
    Values weights(*combine);
    costs.combine.fixed_us = weights.number("fixed_us", 0, 1e6);
    costs.combine.submit_weight = weights.number("submit_weight", 0, 100);
    costs.combine.raster_weight = weights.number("raster_weight", 0, 100);
    costs.combine.max_weight = weights.number("max_weight", 0, 100);
    if (!weights.wrong.empty()) return refuse("combine." + weights.wrong);
    const toml::array* classes = table["class"].as_array();
    if (classes == nullptr || classes->empty()) return refuse("class");
    for (const auto& entry : *classes) {
        if (!entry.is_table()) return refuse("class");
        Values values(*entry.as_table());
        model::CostGrid grid;
        grid.effects = values.count("effects", 0x7fffffffU);
        grid.triangle_steps = values.count("triangle_steps", most_steps);
        grid.pixel_steps = values.count("pixel_steps", most_steps);
        if (grid.triangle_steps == 0 || grid.pixel_steps == 0) values.complain("triangle_steps");
        grid.cells.resize(static_cast<std::size_t>(grid.triangle_steps) * grid.pixel_steps);
        values.numbers("submit_us", grid, &model::ItemCost::submit_us);
        values.numbers("raster_us", grid, &model::ItemCost::raster_us);
        if (!values.wrong.empty()) return refuse("class." + values.wrong);
        costs.grids.push_back(std::move(grid));
    }
    return costs;
}

}  // namespace

std::uint64_t hash_of(const model::CostModel& costs) { return hash_bytes(std::as_bytes(std::span<const char>(body_of(costs)))); }

Result<void> write_costs(const std::string& file, const model::CostModel& costs) {
    const std::string body = body_of(costs);
    return write_text(file, fmt::format("{}{}\"\n{}", hash_key, hash_text(body), body));
}

Result<model::CostModel> read_costs(const std::string& file, const std::string& machine) {
    auto text = read_text(file, 1U << 24U);
    if (!text) return text.error();
    const std::size_t line = text->find('\n');
    if (!text->starts_with(hash_key) || line == std::string::npos)
        return Error{file, "The file is not a cost table", remedy, ErrorKind::damaged};
    const std::string_view body = std::string_view(*text).substr(line + 1);
    const std::string_view first = std::string_view(*text).substr(0, line);
    if (first != fmt::format("{}{}\"", hash_key, hash_text(body))) {
        return Error{file, "The file was changed since it was measured: its checksum does not match", remedy, ErrorKind::damaged};
    }
    model::CostModel costs;
    try {
        auto read = costs_of(toml::parse(body), file);
        if (!read) return read.error();
        costs = std::move(*read);
    } catch (const toml::parse_error& error) {
        return Error{file, fmt::format("The file is not valid TOML: {}", error.description()), remedy, ErrorKind::damaged};
    }
    if (!machine.empty() && costs.machine != machine) {
        return Error{file, fmt::format("The file was measured on another machine: '{}', this is '{}'", costs.machine, machine),
                     remedy, ErrorKind::misuse};
    }
    return costs;
}

std::string machine_identity(const std::string& gl_renderer, int rasterisers) {
    std::ifstream file("/proc/cpuinfo");
    std::string line;
    std::string cpu = "unknown CPU";
    while (std::getline(file, line)) {
        const std::size_t colon = line.find(": ");
        if (line.starts_with("model name") && colon != std::string::npos) {
            cpu = line.substr(colon + 2);
            break;
        }
    }
    return fmt::format("{}, {} cores, {}, {} rasterisers", cpu, std::thread::hardware_concurrency(), gl_renderer,
                       gl::effective_rasterisers(rasterisers));
}

}  // namespace surefoot::measure
