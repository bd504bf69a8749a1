// libFuzzer target: Any text as settings.
#include "tests/fuzz/readers.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    surefoot::fuzz::settings(std::as_bytes(std::span(data, size)));
    return 0;
}
