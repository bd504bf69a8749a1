// How an error reads: "place: What happened. What to do."
#include "rt/base/result.hpp"

namespace surefoot {

std::string_view name_of(ErrorKind kind) {
    switch (kind) {
        case ErrorKind::failed:
            return "failed";
        case ErrorKind::misuse:
            return "misuse";
        case ErrorKind::not_found:
            return "not_found";
        case ErrorKind::unreadable:
            return "unreadable";
        case ErrorKind::unwritable:
            return "unwritable";
        case ErrorKind::damaged:
            return "damaged";
        case ErrorKind::unsupported:
            return "unsupported";
        case ErrorKind::out_of_limits:
            return "out_of_limits";
        case ErrorKind::no_memory:
            return "no_memory";
        case ErrorKind::no_device:
            return "no_device";
        case ErrorKind::no_real_time:
            return "no_real_time";
        case ErrorKind::stopped:
            return "stopped";
    }
    return "failed";
}

std::string_view full_stop_after(std::string_view sentence) {
    constexpr std::string_view ends = ".?!:";
    return sentence.empty() || ends.find(sentence.back()) != std::string_view::npos ? "" : ".";
}

std::string Error::text() const {
    std::string line = place;
    if (!line.empty() && !what.empty()) line += ": ";
    line += what;
    line += full_stop_after(line);
    if (remedy.empty()) return line;
    line += ' ' + remedy;
    line += full_stop_after(line);
    return line;
}

}  // namespace surefoot
