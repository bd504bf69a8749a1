// Rows of `surefoot selftest --hard` without the tool around them: what other compilers, other options and tests/mutations build.
// usage: hard_rows SCALE [ROW...]   prints what each found; exit status 0 if none is broken.
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "tools/selftest/hard.hpp"

int main(int argc, char** argv) {
    using namespace surefoot::selftest;
    const std::vector<std::string> ids(argv + (argc > 2 ? 2 : argc), argv + argc);
    const auto selection = select_rows(ids);
    const double scale = argc > 1 ? std::strtod(argv[1], nullptr) : 0;
    if (!selection || !(scale > 0)) {
        std::fputs("usage: hard_rows SCALE [ROW...]\n", stderr);
        return 2;
    }
    bool fine = true;
    const auto results = run_rows(*selection, {scale}, [&](const RowResult& r) {
        std::fputs(text_of(r).c_str(), stdout);
        std::printf("        digest %016llx\n", static_cast<unsigned long long>(r.outcome.digest));
        fine = fine && r.verdict != Verdict::broken;
    });
    std::puts(summary_of(*results).c_str());
    return fine ? 0 : 1;
}
