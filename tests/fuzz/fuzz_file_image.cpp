// libFuzzer target: Any bytes as a PNG or JPEG.
#include "tests/fuzz/readers.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    surefoot::fuzz::picture(std::as_bytes(std::span(data, size)));
    return 0;
}
