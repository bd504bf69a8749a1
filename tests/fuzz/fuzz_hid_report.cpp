// libFuzzer target: A descriptor and reports for it.
#include "tests/fuzz/targets.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    surefoot::fuzz::reports(std::as_bytes(std::span(data, size)));
    return 0;
}
