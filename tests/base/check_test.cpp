// Checks in every build: one kind ends the program with a message, the other is counted and goes on.
#include "rt/base/check.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "rt/base/mutex.hpp"

namespace surefoot {
namespace {

void claim(int number) { CHECK(number < 3, "numbers are small"); }

TEST(CheckDeathTest, EndsTheProgramWithPlaceExpressionAndSentence) {
    claim(2);
    EXPECT_DEATH(claim(3), "tests/base/check_test.cpp:[0-9]+: CHECK\\(number < 3\\): numbers are small");
}

bool even(int number) { return CHECK_RARE(number % 2 == 0, "numbers are even"); }
/// Each instance has a site of its own, at one place.
template <class T>
bool positive(T number) {
    return CHECK_RARE(number > T{}, "numbers are above zero");
}

std::uint64_t count_of(const std::string& sentence) {
    std::uint64_t count = 0;
    for (const RareCheck& c : rare_checks()) {
        if (c.sentence != sentence) continue;
        EXPECT_EQ(c.place.rfind("tests/base/check_test.cpp:", 0), 0U) << c.place;
        EXPECT_EQ(count, 0U) << "one entry a place";
        count = c.count;
    }
    return count;
}

TEST(CheckRare, CountsAndGoesOn) {
    const std::uint64_t before = rare_check_count();
    EXPECT_TRUE(even(2));
    EXPECT_EQ(count_of("numbers are even"), 0U) << "what holds is not listed";
    EXPECT_FALSE(even(3));
    EXPECT_FALSE(even(5));
    EXPECT_EQ(count_of("numbers are even"), 2U);
    EXPECT_FALSE(positive(0));
    EXPECT_FALSE(positive(-1.0));
    EXPECT_EQ(count_of("numbers are above zero"), 2U);
    EXPECT_EQ(rare_check_count() - before, 4U);
}

bool came(int number) { return CHECK_RARE(number < 0, "nobody comes"); }

TEST(CheckRare, ManyThreadsAtAPlaceAreCountedEachTime) {
    std::vector<std::thread> threads;
    for (int i = 0; i < 4; ++i) {
        threads.emplace_back([] {
            for (int k = 0; k < 1000; ++k) (void)came(k);
        });
    }
    for (std::thread& t : threads) t.join();
    EXPECT_EQ(count_of("nobody comes"), 4000U);
}

TEST(AnnotatedMutex, ConditionWaitsUntilNotifiedOrUntilItsDeadline) {
    Mutex mutex;
    Condition changed;
    bool notified = false;
    {
        const MutexLock lock(mutex);
        while (changed.wait_until(mutex, std::chrono::steady_clock::now() - std::chrono::seconds(1))) {
        }
    }
    std::thread notifier([&] {
        const MutexLock lock(mutex);
        notified = true;
        changed.notify_all();
    });
    {
        const MutexLock lock(mutex);
        const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(10);
        while (!notified && changed.wait_until(mutex, deadline)) {
        }
        EXPECT_TRUE(notified);
    }
    notifier.join();
}

}  // namespace
}  // namespace surefoot
