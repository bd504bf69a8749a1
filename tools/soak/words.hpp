// Inside the report room: words that a soak's table and page share.
#pragma once

#include <string>

namespace surefoot::soak {

/// "45 seconds", "20 minutes", "2 hours".
std::string duration_words(double seconds);

}  // namespace surefoot::soak
