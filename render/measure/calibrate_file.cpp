// The cost table as a file: TOML whose first line holds a checksum of the rest; and what machine it is valid for.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string_view>
#include <thread>

#include "render/measure/calibrate.hpp"
#include "rt/base/file.hpp"
#include "rt/base/hash.hpp"
#include "rt/base/toml_reader.hpp"

namespace surefoot::measure {

namespace {

constexpr std::string_view hash_key = "hash = \"";
constexpr std::uint32_t max_steps = 32;
constexpr int format_version = 1;
constexpr int estimate = 2;  // what is counted: 1 by boxes and whole representations, at a median; 2 as model::ItemCosts does
const char* const remedy = "Run `surefoot calibrate` on this machine";

/// A figure of an effect's price in the file.
struct PriceKey {
    std::string_view name;
    float model::EffectPrice::*of;
    double max_ns;
};
constexpr std::array<PriceKey, 3> price_keys = {{
    {"submit_ns_per_triangle", &model::EffectPrice::submit_ns_per_triangle, max_effect_ns_per_triangle},
    {"raster_ns_per_triangle", &model::EffectPrice::raster_ns_per_triangle, max_effect_ns_per_triangle},
    {"raster_ns_per_pixel", &model::EffectPrice::raster_ns_per_pixel, max_ns_per_pixel},
}};

/// A figure of the image cache in the file.
struct PictureKey {
    std::string_view name;
    float model::CostModel::*of;
    double min, max;
};
constexpr std::array<PictureKey, 4> picture_keys = {{
    {"picture_us", &model::CostModel::picture_us, min_picture_us, max_picture_us},
    {"picture_ns_per_pixel", &model::CostModel::picture_ns_per_pixel, min_picture_ns, max_ns_per_pixel},
    {"capture_us", &model::CostModel::capture_us, min_picture_us, max_picture_us},
    {"capture_ns_per_texel", &model::CostModel::capture_ns_per_texel, min_picture_ns, max_ns_per_pixel},
}};

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
        "{:.9g}\n",
        format_version, estimate, quoted(costs.machine), costs.calibrated, costs.timer_query_honest,
        static_cast<double>(costs.headroom), static_cast<double>(costs.slice_us));
    // Only what was measured: tables of before, and their hashes, stay what they are.
    if (costs.enlarge_measured)
        text += fmt::format("enlarge_ns_per_pixel = {:.9g}\n", static_cast<double>(costs.enlarge_ns_per_pixel));
    if (costs.samples_measured)
        text += fmt::format("sample_share = {:.9g}\nsample_pass_ns_per_pixel = {:.9g}\n", static_cast<double>(costs.sample_share),
                            static_cast<double>(costs.sample_pass_ns_per_pixel));
    if (costs.background_measured)
        text += fmt::format("background_ns_per_pixel = {:.9g}\n", static_cast<double>(costs.background_ns_per_pixel));
    if (costs.pictures_measured)
        for (const PictureKey& key : picture_keys)
            text += fmt::format("{} = {:.9g}\n", key.name, static_cast<double>(costs.*key.of));
    if (costs.trilinear_measured) text += fmt::format("trilinear_factor = {:.9g}\n", static_cast<double>(costs.trilinear_factor));
    if (costs.ns_per_pixel > 0) text += fmt::format("ns_per_pixel = {:.9g}\n", static_cast<double>(costs.ns_per_pixel));
    if (costs.filter != rt::TextureFilter::automatic)
        text += fmt::format("filter = {}\n", quoted(std::string(rt::name_of(costs.filter))));
    if (costs.blur_measured) text += fmt::format("blur_loss = [{:.9g}]\n", fmt::join(costs.blur_loss, ", "));
    text += fmt::format(
        "\n# frame_us = fixed_us + submit_weight * S + raster_weight * R + max_weight * max(S, R)\n[combine]\n"
        "fixed_us = {:.9g}\nsubmit_weight = {:.9g}\nraster_weight = {:.9g}\nmax_weight = {:.9g}\n",
        static_cast<double>(c.fixed_us), static_cast<double>(c.submit_weight), static_cast<double>(c.raster_weight),
        static_cast<double>(c.max_weight));
    for (const model::CostGrid& grid : costs.grids) {
        text += fmt::format(
            "\n# us an item; rows: 2^0, 2^1, ... triangles; columns: 2^0, 2^1, ... pixels\n[[class]]\neffects = {}\n"
            "triangle_steps = {}\npixel_steps = {}\n",
            grid.effects, grid.triangle_steps, grid.pixel_steps);
        add_numbers(text, "submit_us", grid, &model::ItemCost::submit_us);
        add_numbers(text, "raster_us", grid, &model::ItemCost::raster_us);
    }
    if (!costs.prices_measured) return text;
    for (const model::EffectPrice& price : costs.prices) {
        text += fmt::format("\n# what an effect adds to an item\n[[price]]\neffect = {}\n", price.effect);
        for (const PriceKey& key : price_keys) text += fmt::format("{} = {:.9g}\n", key.name, static_cast<double>(price.*key.of));
    }
    return text;
}

/// What is not there is as wrong as what is out of range.
void require_key(TableReader& table, std::string_view key) {
    if (!table.has(key)) table.refuse(key, "is missing", remedy);
}

float needed_number(TableReader& table, std::string_view key, double low, double high) {
    double value = 0;
    require_key(table, key);
    table.number(key, low, high, {}, value);
    return static_cast<float>(value);
}

std::uint32_t needed_count(TableReader& table, std::string_view key, std::uint32_t high) {
    std::int64_t value = 0;
    require_key(table, key);
    table.integer(key, 0, high, value);
    return static_cast<std::uint32_t>(value);
}

void needed_numbers(TableReader& table, std::string_view key, model::CostGrid& grid, float model::ItemCost::*member) {
    std::vector<double> values(grid.cells.size());
    require_key(table, key);
    table.numbers(key, grid.cells.size(), 0, values);
    for (std::size_t i = 0; i < values.size(); ++i) grid.cells[i].*member = static_cast<float>(values[i]);
}

/// Absent: the constant. Returns whether the key is there.
bool read_measured(TableReader& top, std::string_view key, double low, double high, float& constant) {
    auto value = static_cast<double>(constant);
    top.number(key, low, high, {}, value);
    constant = static_cast<float>(value);
    return top.has(key);
}

/// Absent: the constants, and said to be such.
void read_levers(TableReader& top, model::CostModel& costs) {
    costs.enlarge_measured = read_measured(top, "enlarge_ns_per_pixel", 0, max_enlarge_ns, costs.enlarge_ns_per_pixel);
    const bool share = read_measured(top, "sample_share", 0, max_sample_share, costs.sample_share);
    const bool pass = read_measured(top, "sample_pass_ns_per_pixel", 0, max_sample_pass_ns, costs.sample_pass_ns_per_pixel);
    costs.samples_measured = share && pass;
    if (share != pass) top.refuse(share ? "sample_pass_ns_per_pixel" : "sample_share", "is missing", remedy);
    std::size_t filter = 0;
    if (top.has("filter")) {
        constexpr std::array<std::string_view, 2> filters{rt::name_of(rt::TextureFilter::bilinear),
                                                          rt::name_of(rt::TextureFilter::trilinear)};
        top.choice("filter", filters, filter);
        costs.filter = filter == 0 ? rt::TextureFilter::bilinear : rt::TextureFilter::trilinear;
    }
    costs.background_measured = read_measured(top, "background_ns_per_pixel", 0, max_enlarge_ns, costs.background_ns_per_pixel);
    std::size_t pictures = 0;
    for (const PictureKey& key : picture_keys)
        pictures += read_measured(top, key.name, key.min, key.max, costs.*key.of) ? 1U : 0U;
    costs.pictures_measured = pictures == picture_keys.size();
    for (const PictureKey& key : picture_keys)
        if (pictures > 0 && !top.has(key.name)) top.refuse(key.name, "is missing", remedy);
    costs.trilinear_measured = read_measured(top, "trilinear_factor", 1, max_trilinear_factor, costs.trilinear_factor);
}

/// Absent: the constants, and said to be such.
void read_blur(TableReader& top, model::CostModel& costs) {
    constexpr std::string_view key = "blur_loss";
    if (!top.has(key)) return;
    std::vector<double> losses(costs.blur_loss.size());
    top.numbers(key, losses.size(), 0, losses);
    if (losses.front() != 0 || losses.back() > 1 || !std::is_sorted(losses.begin(), losses.end()))
        return top.refuse(key, "does not begin with 0, falls or ends above 1", remedy);
    std::transform(losses.begin(), losses.end(), costs.blur_loss.begin(), [](double loss) { return static_cast<float>(loss); });
    costs.blur_measured = true;
}

/// Absent: none, and said to be so. Returns the key that is wrong; "": none is.
std::string read_prices(const toml::table& table, const std::string& file, model::CostModel& costs) {
    const toml::array* prices = table["price"].as_array();
    if (prices == nullptr) return table.contains("price") ? "price" : "";
    for (const auto& entry : *prices) {
        if (!entry.is_table()) return "price";
        TableReader values(*entry.as_table(), file, "price");
        model::EffectPrice price;
        price.effect = needed_count(values, "effect", 0x7fffffffU);
        const bool twice = std::any_of(costs.prices.begin(), costs.prices.end(),
                                       [&](const model::EffectPrice& other) { return other.effect == price.effect; });
        if (!std::has_single_bit(price.effect) || twice) values.refuse("effect", "is no effect, or comes twice", remedy);
        for (const PriceKey& key : price_keys) price.*key.of = needed_number(values, key.name, 0, key.max_ns);
        if (!values.wrong_key().empty()) return values.wrong_key();
        costs.prices.push_back(price);
    }
    costs.prices_measured = !costs.prices.empty();
    return {};
}

Result<model::CostModel> costs_of(const toml::table& table, const std::string& file) {
    model::CostModel costs;
    const auto refuse = [&](const std::string& key) {
        return Error{file, "The key '" + key + "' is missing or out of range", remedy, ErrorKind::damaged};
    };
    TableReader top(table, file, {});
    if (needed_count(top, "version", 1000) != format_version) return refuse("version");
    costs.machine = table["machine"].value_or(std::string());
    // Then no machine's own: walks say so, and what to do.
    if (table["estimate"].value_or(1) != estimate) costs.machine += ", by another version of the estimate";
    costs.calibrated = table["calibrated"].value_or(false);
    costs.timer_query_honest = table["timer_query_honest"].value_or(false);
    costs.headroom = needed_number(top, "upper_factor", 0.1, 100);
    costs.slice_us = needed_number(top, "slice_us", 0, 1e6);
    read_measured(top, "ns_per_pixel", 0, max_ns_per_pixel, costs.ns_per_pixel);
    read_levers(top, costs);
    read_blur(top, costs);
    if (!top.wrong_key().empty()) return refuse(top.wrong_key());
    const toml::table* combine = table["combine"].as_table();
    if (combine == nullptr) return refuse("combine");
    TableReader weights(*combine, file, "combine");
    costs.combine.fixed_us = needed_number(weights, "fixed_us", 0, 1e6);
    costs.combine.submit_weight = needed_number(weights, "submit_weight", 0, 100);
    costs.combine.raster_weight = needed_number(weights, "raster_weight", 0, 100);
    costs.combine.max_weight = needed_number(weights, "max_weight", 0, 100);
    if (!weights.wrong_key().empty()) return refuse(weights.wrong_key());
    const toml::array* classes = table["class"].as_array();
    if (classes == nullptr || classes->empty()) return refuse("class");
    for (const auto& entry : *classes) {
        if (!entry.is_table()) return refuse("class");
        TableReader values(*entry.as_table(), file, "class");
        model::CostGrid grid;
        grid.effects = needed_count(values, "effects", 0x7fffffffU);
        grid.triangle_steps = needed_count(values, "triangle_steps", max_steps);
        grid.pixel_steps = needed_count(values, "pixel_steps", max_steps);
        if (grid.triangle_steps == 0 || grid.pixel_steps == 0) values.refuse("triangle_steps", "is 0", remedy);
        grid.cells.resize(static_cast<std::size_t>(grid.triangle_steps) * grid.pixel_steps);
        needed_numbers(values, "submit_us", grid, &model::ItemCost::submit_us);
        needed_numbers(values, "raster_us", grid, &model::ItemCost::raster_us);
        if (!values.wrong_key().empty()) return refuse(values.wrong_key());
        costs.grids.push_back(std::move(grid));
    }
    if (const std::string wrong = read_prices(table, file, costs); !wrong.empty()) return refuse(wrong);
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
    auto table = parse_toml(*text, file);
    if (!table) {
        Error error = table.error();
        error.remedy = remedy;
        return error;
    }
    auto costs = costs_of(*table, file);
    if (costs && !machine.empty() && costs->machine != machine) {
        return Error{file, fmt::format("The file was measured on another machine: '{}', this is '{}'", costs->machine, machine),
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
