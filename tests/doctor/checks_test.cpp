// Every check on made-up machines: one that passes, one that fails, and one where nothing can be seen.
#include "tools/doctor/check.hpp"

#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <map>
#include <set>

#include "tests/doctor/cases.hpp"

namespace surefoot::doctor {
namespace {

std::vector<Case> all_cases() {
    std::vector<Case> all;
    for (const auto& some : {scheduling_cases(), machine_cases(), service_cases()})
        all.insert(all.end(), some.begin(), some.end());
    return all;
}

Wanted on_core_one() {
    Wanted wanted;
    wanted.frame_core = 1;
    return wanted;
}

Finding find(const Machine& machine, const std::string& name) {
    for (const Check& check : all_checks()) {
        if (check.name == name) return check.run(machine);
    }
    ADD_FAILURE() << "no check " << name;
    return {};
}

TEST(Doctor, EveryCasePassesOrFailsAsItShould) {
    for (const Case& c : all_cases()) {
        const FakeRoot root(c.files);
        Probed probed;
        if (c.probed) c.probed(probed);
        const Finding finding = find(Machine(root.path(), on_core_one(), probed), c.check);
        EXPECT_EQ(status_name(finding.status), c.passes ? "pass" : "fail")
            << c.check << ": " << finding.evidence << " / wanted " << c.evidence;
        EXPECT_NE(finding.evidence.find(c.evidence), std::string::npos)
            << c.check << ": " << finding.evidence << " / wanted " << c.evidence;
        EXPECT_EQ(finding.evidence.find(root.path()), std::string::npos)
            << "evidence names paths as the machine does: " << finding.evidence;
        if (!c.passes) {
            EXPECT_GT(finding.remedy.size(), 10U) << c.check << " has no remedy";
        }
        if (c.passes) {
            EXPECT_TRUE(finding.remedy.empty()) << c.check << " mends what is not broken";
        }
    }
}

TEST(Doctor, EveryCheckHasAMachineThatPassesAndOneThatFails) {
    std::map<std::string_view, std::set<bool>> seen;
    const auto cases = all_cases();
    for (const Case& c : cases) seen[c.check].insert(c.passes);
    for (const Check& check : all_checks()) EXPECT_EQ(seen[check.name].size(), 2U) << check.name;
}

TEST(Doctor, WhatCannotBeSeenIsUnknownAndHasARemedy) {
    const FakeRoot empty;
    const FakeRoot folders({{"/proc/", ""}, {"/sys/", ""}, {"/etc/", ""}, {"/dev/", ""}});
    for (const FakeRoot* root : {&empty, &folders}) {
        for (const Wanted& wanted : {Wanted{}, on_core_one()}) {
            for (const Examined& e : examine(Machine(root->path(), wanted, {}))) {
                EXPECT_EQ(status_name(e.finding.status), "unknown") << e.check.name << ": " << e.finding.evidence;
                EXPECT_FALSE(e.finding.evidence.empty()) << e.check.name;
                EXPECT_FALSE(e.finding.remedy.empty()) << e.check.name;
            }
        }
    }
}

/// Files that are there but hold nothing, or nonsense, or a number beyond all measure: never a pass by accident, never a crash.
TEST(Doctor, NonsenseNeverPasses) {
    const std::set<std::string> judged_by_being_there = {"devices.hidraw",      "devices.gpio",    "devices.dri",
                                                         "devices.udev_rule",   "service.systemd", "service.journald",
                                                         "service.journal_kept"};
    for (const std::string text : {"", "\n", "nonsense", "99999999999999999999", "((([[[", ":::\n:::", "-"}) {
        FakeFiles files;
        const auto cases = all_cases();
        for (const Case& c : cases) {
            for (const FakeFile& file : c.files) {
                if (!file.path.ends_with('/')) files.push_back({file.path, text, file.mode});
            }
        }
        const FakeRoot root(files);
        for (const Examined& e : examine(Machine(root.path(), on_core_one(), {}))) {
            const std::string name(e.check.name);
            if (judged_by_being_there.contains(name)) continue;
            // No word among nonsense is "irqbalance", and an option that a readable configuration does not name is not set.
            if (name == "interrupts.irqbalance" || name == "kernel.rt_group_sched") continue;
            EXPECT_NE(status_name(e.finding.status), "pass") << name << " passes on '" << text << "': " << e.finding.evidence;
        }
    }
}

TEST(Doctor, NamesAreUniqueAndGroupedByTopic) {
    std::set<std::string_view> names;
    std::vector<std::string> topics;
    for (const Check& check : all_checks()) {
        EXPECT_TRUE(names.insert(check.name).second) << check.name;
        const auto dot = check.name.find('.');
        ASSERT_NE(dot, std::string_view::npos) << check.name;
        EXPECT_EQ(check.name.find_first_not_of("abcdefghijklmnopqrstuvwxyz_."), std::string_view::npos) << check.name;
        EXPECT_GT(check.what.size(), 5U) << check.name;
        const std::string topic(check.name.substr(0, dot));
        if (topics.empty() || topics.back() != topic) topics.push_back(topic);
    }
    EXPECT_GE(names.size(), 25U);
    EXPECT_EQ(std::set<std::string>(topics.begin(), topics.end()).size(), topics.size()) << "a topic's checks stand apart";
}

TEST(Doctor, UnknownIsNoPass) {
    const FakeRoot empty;
    const auto examined = examine(Machine(empty.path(), {}, {}));
    const Summary summary = summarise(examined);
    EXPECT_EQ(summary.pass, 0);
    EXPECT_EQ(summary.fail, 0);
    EXPECT_EQ(summary.unknown, static_cast<int>(examined.size()));
}

TEST(Doctor, TheFrameCoreIsTheLastIsolatedOneThatMayBeUsed) {
    const FakeFile allowed = {"/proc/self/status", "Cpus_allowed_list:\t0-3\n"};
    const FakeRoot plain(FakeFiles{allowed});
    EXPECT_EQ(Machine(plain.path(), {}, {}).frame_core(), 3);
    const FakeRoot isolated({allowed, {"/sys/devices/system/cpu/isolated", "1-2,7\n"}});
    EXPECT_EQ(Machine(isolated.path(), {}, {}).frame_core(), 2);
    EXPECT_EQ(Machine(isolated.path(), on_core_one(), {}).frame_core(), 1);
    Probed probed;
    probed.isolated = rt::CpuMask{7};
    EXPECT_EQ(Machine(isolated.path(), {}, probed).frame_core(), 7) << "isolcpus= takes it from the mask, and it is granted";
    const FakeRoot online(FakeFiles{{"/sys/devices/system/cpu/online", "0-1\n"}});
    EXPECT_EQ(Machine(online.path(), {}, {}).frame_core(), 1);
}

TEST(Doctor, APackedKernelConfigurationIsRead) {
    const FakeRoot root(FakeFiles{{"/proc/", ""}});
    const gzFile packed = gzopen((root.path() + "/proc/config.gz").c_str(), "wb");
    const std::string text = "CONFIG_HZ=250\nCONFIG_RT_GROUP_SCHED=y\n# CONFIG_NO_HZ_FULL is not set\n";
    gzwrite(packed, text.data(), static_cast<unsigned>(text.size()));
    gzclose(packed);
    const Machine machine(root.path(), {}, {});
    EXPECT_EQ(machine.build_option("CONFIG_HZ"), "250");
    EXPECT_EQ(machine.build_option("CONFIG_RT_GROUP_SCHED"), "y");
    EXPECT_EQ(machine.build_option("CONFIG_NO_HZ_FULL"), "n");
}

TEST(Doctor, RemediesNameThisMachinesNumbers) {
    const FakeRoot root({{"/sys/devices/virtual/workqueue/cpumask", "ff,ffffffff\n"},
                         {"/proc/irq/default_smp_affinity", "f\n"},
                         {"/sys/devices/system/cpu/online", "0-3\n"},
                         {"/proc/irq/9/smp_affinity_list", "0-3\n"},
                         {"/proc/irq/10/smp_affinity_list", "1\n"},
                         {"/sys/devices/system/cpu/cpu1/topology/thread_siblings_list", "1,3\n"}});
    const Machine machine(root.path(), on_core_one(), {});
    EXPECT_EQ(find(machine, "interrupts.kernel_work").remedy, "echo ff,fffffffd > /sys/devices/virtual/workqueue/cpumask");
    EXPECT_EQ(find(machine, "interrupts.new_devices").remedy,
              "echo d > /proc/irq/default_smp_affinity; at boot: irqaffinity=0,2-3");
    EXPECT_EQ(find(machine, "interrupts.affinity").remedy,
              "for i in 9 10; do echo 0,2-3 > /proc/irq/$i/smp_affinity_list; done; at boot: irqaffinity=0,2-3");
    EXPECT_NE(find(machine, "cores.smt_sibling").remedy.find("echo 0 > /sys/devices/system/cpu/cpu3/online"), std::string::npos);
}

}  // namespace
}  // namespace surefoot::doctor
