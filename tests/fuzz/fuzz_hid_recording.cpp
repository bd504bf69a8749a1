// libFuzzer target: Any text as a recording of reports.
#include "tests/fuzz/targets.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    surefoot::fuzz::recording(std::as_bytes(std::span(data, size)));
    return 0;
}
