// Checks that failed: the message, and the list of counted ones.
#include "rt/base/check.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace surefoot {

namespace {

std::atomic<RareSite*> first_seen{nullptr};

/// From the root of the sources, wherever they were compiled.
const char* from_root(const char* file) {
    constexpr std::string_view here = __FILE__, own = "rt/base/check.cpp";
    if constexpr (here.ends_with(own)) {
        constexpr std::string_view root = here.substr(0, here.size() - own.size());
        if (std::string_view(file).starts_with(root)) return file + root.size();
    }
    return file;
}

}  // namespace

void check_failed(const CheckSite& site) noexcept {
    char text[512];
    const int size = std::snprintf(text, sizeof text, "%s:%d: CHECK(%s): %s\n", from_root(site.file), site.line, site.expression,
                                   site.sentence);
    if (size > 0) (void)!::write(STDERR_FILENO, text, std::min<std::size_t>(static_cast<std::size_t>(size), sizeof text - 1));
    std::abort();
}

void RareSite::count() noexcept {
    if (count_.fetch_add(1, std::memory_order_relaxed) != 0) return;
    RareSite* first = first_seen.load(std::memory_order_relaxed);
    do {
        next_ = first;
    } while (!first_seen.compare_exchange_weak(first, this, std::memory_order_release, std::memory_order_relaxed));
}

std::vector<RareCheck> rare_checks() {
    std::vector<RareCheck> seen;
    for (const RareSite* s = first_seen.load(std::memory_order_acquire); s != nullptr; s = s->next_) {
        const std::string place = std::string(from_root(s->site_.file)) + ":" + std::to_string(s->site_.line);
        const std::uint64_t count = s->count_.load(std::memory_order_relaxed);
        // A template has a site in each of its instances.
        const auto same = std::find_if(seen.begin(), seen.end(), [&](const RareCheck& c) { return c.place == place; });
        if (same != seen.end())
            same->count += count;
        else
            seen.push_back({place, s->site_.sentence, count});
    }
    std::sort(seen.begin(), seen.end(), [](const RareCheck& a, const RareCheck& b) { return a.place < b.place; });
    return seen;
}

std::uint64_t rare_check_count() noexcept {
    std::uint64_t sum = 0;
    for (const RareSite* s = first_seen.load(std::memory_order_acquire); s != nullptr; s = s->next_)
        sum += s->count_.load(std::memory_order_relaxed);
    return sum;
}

}  // namespace surefoot
