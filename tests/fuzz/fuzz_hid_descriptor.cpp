// libFuzzer target: Any bytes as a report descriptor.
#include "tests/fuzz/targets.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    surefoot::fuzz::descriptor(std::as_bytes(std::span(data, size)));
    return 0;
}
