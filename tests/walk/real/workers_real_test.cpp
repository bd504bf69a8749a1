// The preparation's workers on the machine's own clock: each in its place from its first task on, by /proc, at any number of
// them.
#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>

#include "render/model/walk_file.hpp"
#include "rt/base/mutex.hpp"
#include "rt/threads/capability.hpp"
#include "tests/walk/walk_fixture.hpp"
#include "tools/walk/placing.hpp"
#include "tools/walk/worker_places.hpp"

namespace surefoot {
namespace {

struct Scheduled {
    std::string name;
    int priority = 0, policy = -1;
};

/// /proc/<pid>/stat: the name in brackets is the second field; the priority is the 40th, the policy the 41st.
Scheduled read_stat(const std::string& task) {
    std::ifstream file(task + "/stat");
    std::stringstream text;
    text << file.rdbuf();
    const std::string line = text.str();
    const std::size_t open = line.find('('), close = line.rfind(')');
    if (open == std::string::npos || close == std::string::npos) return {};  // it has ended
    Scheduled s{line.substr(open + 1, close - open - 1)};
    std::istringstream fields(line.substr(close + 1));
    std::string skipped;
    for (int field = 3; field < 40; ++field) fields >> skipped;
    fields >> s.priority >> s.policy;
    return s;
}

std::vector<Scheduled> threads_named(const std::string& prefix) {
    std::vector<Scheduled> found;
    for (const auto& task : std::filesystem::directory_iterator("/proc/self/task"))
        if (Scheduled s = read_stat(task.path()); s.name.starts_with(prefix)) found.push_back(s);
    return found;
}

void expect_fifo(const std::vector<Scheduled>& threads, int priority) {
    for (const Scheduled& s : threads) {
        EXPECT_EQ(s.policy, SCHED_FIFO) << s.name;
        EXPECT_EQ(s.priority, priority) << s.name;
    }
}

class Workers : public testing::TestWithParam<int> {
protected:
    void SetUp() override {
        if (rt::probe_capabilities(80).fifo_priority < 80)
            GTEST_SKIP() << "SCHED_FIFO 80 is refused here: run as root or with RLIMIT_RTPRIO";
    }
};

TEST_P(Workers, OfAWalkAreInTheirPlacesBeforeTheFirstFrameAndTheCensusCountsThem) {
    const int workers = GetParam();
    walk::WalkRequest request = test::Forest::get().virtual_request(60);
    request.clock = rt::ClockKind::real;
    request.rate_hz = 100;
    request.workers = workers;
    std::vector<Scheduled> started, preparing;
    walk::WalkObserver observer;
    observer.on_started = [&](const walk::WalkStart&) {
        started = threads_named("sf-worker");
        preparing = threads_named("sf-prepare");
    };
    const auto outcome = walk::run_walk(request, {}, observer);
    ASSERT_TRUE(outcome.ok()) << outcome.error().text();
    EXPECT_EQ(started.size(), static_cast<std::size_t>(workers - 1)) << "the walk's own thread is one of the workers";
    EXPECT_EQ(preparing.size(), 1U);
    expect_fifo(started, request.worker_priority);
    expect_fifo(preparing, request.worker_priority);

    const report::WalkSummary& s = outcome->summary;
    for (const std::string& problem : s.census_problems) ADD_FAILURE() << problem;
    const auto row = std::find_if(s.threads.begin(), s.threads.end(), [](const auto& t) { return t.name == "sf-worker"; });
    ASSERT_NE(row, s.threads.end()) << "the census has no such row";
    EXPECT_EQ(row->count, static_cast<std::uint32_t>(workers - 1));
    EXPECT_EQ(row->priority, request.worker_priority);
    EXPECT_TRUE(threads_named("sf-worker").empty()) << "they end with the walk";
}

TEST_P(Workers, AreInTheirPlacesWithinTheirFirstTask) {
    auto model = model::read_walk(test::Forest::get().model_file);
    ASSERT_TRUE(model.ok());
    const model::CostModel costs = model::default_costs();
    walk::WalkRequest request;
    auto plan = walk::plan_placing(request, true);
    ASSERT_TRUE(plan.ok());
    plan->workers = GetParam();
    walk::WorkerPlaces places(*plan);
    prepare::PrepareOptions options;
    options.workers = plan->workers;
    options.worker_hooks = places.hooks();
    Mutex mutex;
    std::vector<Scheduled> at_work;
    options.worker_hooks.on_first_task = [&, look = options.worker_hooks.on_first_task] {
        look();
        Scheduled here = read_stat("/proc/self/task/" + std::to_string(gettid()));
        const MutexLock lock(mutex);
        at_work.push_back(std::move(here));
    };
    std::optional<prepare::Preparer> preparer(std::in_place, *model, costs, options);
    {
        const walk::ScopedWorkerPriority at_worker_priority(*plan);
        preparer.reset();
    }
    EXPECT_EQ(at_work.size(), static_cast<std::size_t>(plan->workers - 1));
    std::sort(at_work.begin(), at_work.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
    for (std::size_t i = 0; i < at_work.size(); ++i) EXPECT_EQ(at_work[i].name, "sf-worker-" + std::to_string(i + 1));
    expect_fifo(at_work, request.worker_priority);
    EXPECT_EQ(places.problems(), std::vector<std::string>{});
    EXPECT_FALSE(places.refused());
}

INSTANTIATE_TEST_SUITE_P(ThreeAndSeven, Workers, testing::Values(3, 7));

}  // namespace
}  // namespace surefoot
