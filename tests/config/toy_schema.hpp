// A schema with made-up names handed to it, and a table of renamed keys: what the settings know of rooms is only this.
#pragma once

#include <array>

#include "config/settings.hpp"

namespace surefoot::config::test {

inline constexpr std::array renamed = {
    Renamed{"frame_rate", "rate_hz"},
    Renamed{"smoothing", "", "It smoothed nothing. Take it out"},
};

inline const Schema& toy_schema() {
    static const Schema schema({{{"flat", "all of it"}, {"steep", "what is near"}}, "steep"},
                               {{{"paper", "drawn by hand"}, {"glass", "etched"}}, "paper", {{"smoke", "is planned"}}}, renamed);
    return schema;
}

}  // namespace surefoot::config::test
