// make_session NAME OUT.hid: a recorded session for the tests of the command line, and to try out `surefoot walk --input`.
#include <cstdio>
#include <string>

#include "rt/base/file.hpp"
#include "tests/input/gamepad_session.hpp"

int main(int argc, char** argv) {
    using surefoot::input::test::GamepadSession;
    const std::string name = argc == 3 ? argv[1] : "";
    GamepadSession session;
    if (name == "walk-and-turn") {
        session = surefoot::input::test::walk_and_turn();
    } else if (name == "buttons") {
        session.report({});
        session.hold({}, 0.2).press(GamepadSession::next_viewpoint).press(GamepadSession::tour).hold({}, 0.5);
        session.press(GamepadSession::pause).press(GamepadSession::reset);
    } else if (name == "stopped") {  // with the fifth button bound to stop
        session.report({}).hold({.forward = 1}, 1).hold({.forward = 1, .buttons = GamepadSession::fifth}, 1);
    } else {
        (void)std::fputs("usage: make_session walk-and-turn|buttons|stopped OUT.hid\n", stderr);
        return 2;
    }
    const auto written = surefoot::write_text(argv[2], session.text());
    if (!written) (void)std::fprintf(stderr, "%s\n", written.error().text().c_str());
    return written ? 0 : 1;
}
