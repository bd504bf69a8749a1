// The registry of backends. To add one: a file in this folder, its BackendKind, and an entry in backends.cpp. Schema, help and
// settings page follow.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "render/gl/device.hpp"
#include "rt/base/named.hpp"
#include "rt/base/result.hpp"

namespace surefoot::gl {

class Context;

/// The registry entry of a back end.
struct Backend {
    std::string_view name, help;
    BackendKind kind = BackendKind::null;
    Result<std::unique_ptr<Context>> (*open)(const DeviceOptions& options) = nullptr;  ///< null: it draws nothing
    [[nodiscard]] bool draws() const { return open != nullptr; }
};

constexpr std::string_view usual_backend = "egl";
/// The one with a window, whose keyboard and mouse may steer.
constexpr std::string_view window_backend = "window";

std::span<const Backend> backends();
const Backend& backend_of(BackendKind kind);
/// An unknown name is an Error that lists the known ones.
Result<const Backend*> backend_named(std::string_view name);
/// "egl, device, window, kms, osmesa": those that draw pictures.
std::string drawing_backends();

}  // namespace surefoot::gl
