// libFuzzer target: Any bytes as a .walk file.
#include "tests/fuzz/readers.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    surefoot::fuzz::walk_file(std::as_bytes(std::span(data, size)));
    return 0;
}
