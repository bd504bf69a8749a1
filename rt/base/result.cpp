// How an error reads: "place: what (remedy)".
#include "rt/base/result.hpp"

namespace surefoot {

std::string Error::text() const {
    std::string line = place;
    if (!line.empty() && !what.empty()) line += ": ";
    line += what;
    if (!remedy.empty()) line += " (" + remedy + ")";
    return line;
}

}  // namespace surefoot
