// Checks of what "cannot happen", in every build. CHECK ends the program with a message; CHECK_RARE counts and continues.
// Neither allocates or locks; a check that holds costs one comparison.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

namespace surefoot {

/// The place of a check, and its sentence.
struct CheckSite {
    const char* file;
    int line;
    const char* expression;
    const char* sentence;
};

/// "rt/clock/grid.cpp:31: CHECK(period > 0): The period of a grid is above zero", on stderr; then abort().
[[noreturn]] void check_failed(const CheckSite& site) noexcept;

/// One CHECK_RARE. At its first count it joins the list of failed checks for good.
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

/// A CHECK_RARE that failed.
struct RareCheck {
    std::string place;  ///< "render/engine.cpp:171"
    std::string sentence;
    std::uint64_t count = 0;
};
/// All failed CHECK_RAREs of this process, sorted by place; usually empty. Any thread; allocates.
std::vector<RareCheck> rare_checks();
/// The sum of their counts. Any thread.
std::uint64_t rare_check_count() noexcept;

}  // namespace surefoot

/// `sentence`: a literal, a whole sentence that says what must hold.
#define CHECK(condition, sentence) \
    ((condition) ? static_cast<void>(0) : ::surefoot::check_failed({__FILE__, __LINE__, #condition, sentence}))

/// An expression: whether the condition holds. The caller continues in both cases and must be safe in both.
#define CHECK_RARE(condition, sentence)                                                              \
    ((condition) ? true : ([]() noexcept {                                                           \
        static constinit ::surefoot::RareSite rare_site{{__FILE__, __LINE__, #condition, sentence}}; \
        rare_site.count();                                                                           \
        return false;                                                                                \
    })())
