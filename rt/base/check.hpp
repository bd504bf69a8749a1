// What "cannot happen", said where the code relies on it, in every build: CHECK ends the program with a message, CHECK_RARE
// counts and goes on. Neither allocates nor locks; where all is well each is one comparison.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

namespace surefoot {

/// Where a check stands and what it says.
struct CheckSite {
    const char* file;
    int line;
    const char* expression;
    const char* sentence;
};

/// "rt/clock/grid.cpp:31: CHECK(period > 0): a grid has a period", on stderr; then abort().
[[noreturn]] void check_failed(const CheckSite& site) noexcept;

/// One CHECK_RARE; joins the list of those that were seen at its first count, and stays there.
class RareSite {
public:
    constexpr explicit RareSite(const CheckSite& site) : site_(site) {}
    RareSite(const RareSite&) = delete;
    RareSite& operator=(const RareSite&) = delete;
    void count() noexcept;

private:
    friend std::vector<struct RareCheck> rare_checks();
    friend std::uint64_t rare_check_count() noexcept;
    CheckSite site_;
    std::atomic<std::uint64_t> count_{0};
    RareSite* next_ = nullptr;
};

/// What was seen of one place that "cannot happen".
struct RareCheck {
    std::string place;  ///< "render/engine.cpp:171"
    std::string sentence;
    std::uint64_t count = 0;
};
/// Of this process, sorted by place; empty: nothing that cannot happen has happened. Any thread; allocates.
std::vector<RareCheck> rare_checks();
/// All of them together. Any thread.
std::uint64_t rare_check_count() noexcept;

}  // namespace surefoot

/// `sentence`: a literal that says what must hold.
#define CHECK(condition, sentence) \
    ((condition) ? static_cast<void>(0) : ::surefoot::check_failed({__FILE__, __LINE__, #condition, sentence}))

/// An expression: whether it holds. The caller goes on in both cases, so it must be safe in both.
#define CHECK_RARE(condition, sentence)                                                              \
    ((condition) ? true : ([]() noexcept {                                                           \
        static constinit ::surefoot::RareSite rare_site{{__FILE__, __LINE__, #condition, sentence}}; \
        rare_site.count();                                                                           \
        return false;                                                                                \
    })())
