// libFuzzer target: Any text as an address to listen at, and as a request's Host.
#include "tests/fuzz/readers.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    surefoot::fuzz::address(std::as_bytes(std::span(data, size)));
    return 0;
}
