// Figures of /proc files.
#include "tools/soak/proc_figure.hpp"

#include <algorithm>

#include "rt/base/file.hpp"
#include "rt/base/text.hpp"

namespace surefoot::soak {

std::uint64_t proc_figure(std::string_view text, std::string_view name) {
    for (std::size_t at = text.find(name); at != std::string_view::npos; at = text.find(name, at + 1)) {
        std::string_view rest = text.substr(at + name.size());
        const bool is_whole = (at == 0 || text[at - 1] == '\n') && rest.find_first_of(" :") == 0;
        if (!is_whole) continue;
        rest.remove_prefix(std::min(rest.find_first_not_of(" :\t"), rest.size()));
        return leading_number<std::uint64_t>(rest, 0);
    }
    return 0;
}

std::uint64_t proc_figure_of(const std::string& file, std::string_view name) {
    const auto text = read_text(file, 1U << 22U);
    return text ? proc_figure(*text, name) : 0;
}

}  // namespace surefoot::soak
