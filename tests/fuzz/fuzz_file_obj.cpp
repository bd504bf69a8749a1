// libFuzzer target: Any bytes as an OBJ file.
#include "tests/fuzz/readers.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    surefoot::fuzz::obj(std::as_bytes(std::span(data, size)));
    return 0;
}
