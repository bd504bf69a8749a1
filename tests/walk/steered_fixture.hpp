// Walks steered by recorded sessions, for the tests of the session.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "rt/base/file.hpp"
#include "tests/input/gamepad_session.hpp"
#include "tests/walk/walk_fixture.hpp"

namespace surefoot::test {

using input::test::GamepadSession;
using input::test::ten_thousand_events;

inline std::string keep(const GamepadSession& session, const std::string& name) {
    std::string file = Forest::get().dir + "/" + name + ".hid";
    EXPECT_TRUE(write_text(file, session.text()).ok());
    return file;
}

/// On the virtual clock and without GL; ends where the recording does.
inline walk::WalkRequest steered_request(const GamepadSession& session, const std::string& name) {
    walk::WalkRequest request = Forest::get().virtual_request(0);
    request.input_file = keep(session, name);
    request.walking = rt::WalkingMode::fly;  // what these tests see is the device; those of walking set it back
    return request;
}

inline dvec3 eye(const rt::FrameRecord& r) { return {r.eye[0], r.eye[1], r.eye[2]}; }
inline dquat orientation(const rt::FrameRecord& r) {
    return {r.orientation[3], r.orientation[0], r.orientation[1], r.orientation[2]};
}
/// The frame at a time after the walk's start, at 30 Hz.
inline const rt::FrameRecord& at(const walk::WalkOutcome& outcome, double seconds) {
    return outcome.records.at(static_cast<std::size_t>(std::lround(seconds * 30.0)));
}

}  // namespace surefoot::test
