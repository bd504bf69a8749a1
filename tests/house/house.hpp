// The table of rooms: which room may include which, and where a file belongs. Pure functions of paths.
#pragma once

#include <algorithm>
#include <array>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace surefoot::house {

/// A room's folder, and the folders that it may include beside its own and rt/base, which everyone may.
/// "*": all. A trailing '/' means everything below.
struct Room {
    std::string_view folder;
    std::vector<std::string_view> may_include;
};

inline const std::vector<Room>& rooms() {
    // All rooms below the tools, and what a tool includes beside them.
    const auto below_tools_and = [](std::initializer_list<std::string_view> tools) {
        std::vector<std::string_view> folders = {"rt/", "config", "input", "input/", "render/", "render"};
        folders.insert(folders.end(), tools);
        return folders;
    };
    static const std::vector<Room> table = {
        {"rt/base", {}},
        {"rt/clock", {"rt/"}},
        {"rt/threads", {"rt/"}},
        {"rt/exchange", {"rt/"}},
        {"rt/frame", {"rt/"}},
        {"rt/monitor", {"rt/"}},
        {"config", {}},
        {"input", {"rt/", "input/"}},
        {"input/devices", {"rt/", "input", "input/"}},
        {"input/gpio", {"rt/", "input", "input/"}},
        {"input/hid", {"rt/", "input", "input/"}},
        {"input/map", {"rt/", "input", "input/"}},
        {"input/motion", {"rt/", "input", "input/"}},
        {"input/replay", {"rt/", "input", "input/"}},
        {"input/safety", {"rt/", "input", "input/"}},
        {"input/window", {"rt/", "input", "input/"}},
        {"render/model", {}},
        {"render/model/ground", {"render/model"}},
        {"render/image", {}},
        {"render/import", {"render/model", "render/image"}},
        // Calibration draws with the programs of the effects whose cost it measures.
        {"render/measure", {"render/model", "render/gl", "render/effects", "rt/clock", "rt/threads"}},
        {"render/bake",
         {"render/model", "render/model/ground", "render/image", "render/import", "render/measure", "render/effects"}},
        {"render/draw", {"render/model"}},
        {"render/gl", {"render/model", "render/draw"}},
        {"render/prepare", {"render/model", "rt/clock"}},
        {"render/select", {"render/model", "render/prepare"}},
        {"render/effects", {"render/model", "render/gl"}},
        {"render/cache", {"render/model"}},
        {"render/capture", {"render/model", "render/prepare", "render/select"}},
        {"render", {"render/"}},  // the door, engine.hpp, and what stands right behind it
        {"tools/walk", below_tools_and({"tools/report", "tools/scenes"})},
        // Features: each a room that stands on the session, and on no other feature.
        {"tools/soak", below_tools_and({"tools/report", "tools/walk"})},
        {"tools/accuracy", below_tools_and({"tools/report", "tools/walk"})},
        {"tools/monitor", below_tools_and({"tools/report", "tools/walk"})},
        {"tools/doctor", below_tools_and({"tools/report", "tools/walk"})},
        {"tools/selftest", below_tools_and({"tools/scenes"})},
        {"tools/cache_study", below_tools_and({"tools/scenes"})},
        {"tools/cli", below_tools_and({"tools/"})},
        {"systemd/daemon", {"rt/", "config", "tools/walk", "tools/monitor"}},
        {"tools/report", {"rt/", "render/image", "render/model", "render/model/ground"}},
        {"tools/scenes", {"render/image", "render/import", "render/model"}},
        {"tests", {"*"}},
    };
    return table;
}

/// The room that a file (path from the root) is in: the longest folder that matches; null for none.
/// Below "render" and "input" only files right in them count: an unknown sub-folder is no room. A way back ("..") is none either.
inline const Room* room_of(std::string_view path) {
    if (path.find("./") != std::string_view::npos) return nullptr;
    const Room* best = nullptr;
    for (const Room& room : rooms()) {
        if (path.size() <= room.folder.size() || !path.starts_with(room.folder) || path[room.folder.size()] != '/') continue;
        if ((room.folder == "render" || room.folder == "input") &&
            path.find('/', room.folder.size() + 1) != std::string_view::npos)
            continue;
        if (best == nullptr || room.folder.size() > best->folder.size()) best = &room;
    }
    return best;
}

inline bool allowed(const Room& from, const Room& to) {
    if (&from == &to || to.folder == "rt/base") return true;
    return std::any_of(from.may_include.begin(), from.may_include.end(), [&](std::string_view rule) {
        return rule == "*" || rule == to.folder || (rule.ends_with('/') && to.folder.starts_with(rule));
    });
}

/// What is wrong with `#include "included"` in `file`, or nothing.
inline std::string include_problem(std::string_view file, std::string_view included) {
    const Room* from = room_of(file);
    const Room* to = room_of(included);
    const std::string arrow = std::string(file) + " includes \"" + std::string(included) + "\"";
    if (from == nullptr) return std::string(file) + " is in no room";
    if (to == nullptr) return arrow + ", which is in no room (includes are relative to the root)";
    if (!allowed(*from, *to)) return arrow + ": " + std::string(from->folder) + " may not include " + std::string(to->folder);
    return {};
}

/// What is wrong with `#include <header>` in `file`, or nothing: graphics headers belong to render/gl.
inline std::string system_include_problem(std::string_view file, std::string_view header) {
    constexpr std::array<std::string_view, 8> graphics = {"GL/", "EGL/", "GLES", "KHR/", "gbm.h", "xf86drm", "X11/", "wayland-"};
    const bool is_graphics =
        std::any_of(graphics.begin(), graphics.end(), [&](std::string_view g) { return header.starts_with(g); });
    if (!is_graphics || file.starts_with("render/gl/")) return {};
    return std::string(file) + " includes <" + std::string(header) + ">: only render/gl may";
}

/// The name between quotes or angle brackets of an include line, with its opening sign in front; empty for other lines.
inline std::string include_in(std::string_view line) {
    const auto skip_space = [&] { line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size())); };
    skip_space();
    if (!line.starts_with('#')) return {};
    line.remove_prefix(1);
    skip_space();
    if (!line.starts_with("include")) return {};
    line.remove_prefix(7);
    skip_space();
    if (line.empty() || (line.front() != '"' && line.front() != '<')) return {};
    const auto end = line.find(line.front() == '"' ? '"' : '>', 1);
    return end == std::string_view::npos ? std::string() : std::string(line.substr(0, end));
}

/// Entries that the top level may hold, beside dot-files and what git ignores.
inline bool top_level_allowed(std::string_view name) {
    constexpr std::array<std::string_view, 14> planned = {
        "CMakeLists.txt", "CMakePresets.json", "rt",           "render",          "input",  "config", "systemd", "tests", "tools",
        "README.md",      "ARCHITECTURE.md",   "CHANGELOG.md", "CONTRIBUTING.md", "LICENSE"};
    const bool ignored = name.starts_with("build") || name == "compile_commands.json" || name.ends_with(".tmp");
    return name.starts_with('.') || ignored || std::find(planned.begin(), planned.end(), name) != planned.end();
}

}  // namespace surefoot::house
