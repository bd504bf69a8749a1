// Who may touch what, as the compiler checks it: clang's -Wthread-safety reads these, other compilers see nothing.
#pragma once

#ifdef __clang__
#define SUREFOOT_THREADS(x) __attribute__((x))
#else
#define SUREFOOT_THREADS(x)
#endif

#define CAPABILITY(name) SUREFOOT_THREADS(capability(name))
#define SCOPED_CAPABILITY SUREFOOT_THREADS(scoped_lockable)
#define GUARDED_BY(x) SUREFOOT_THREADS(guarded_by(x))
#define PT_GUARDED_BY(x) SUREFOOT_THREADS(pt_guarded_by(x))
#define REQUIRES(...) SUREFOOT_THREADS(requires_capability(__VA_ARGS__))
#define EXCLUDES(...) SUREFOOT_THREADS(locks_excluded(__VA_ARGS__))
#define ACQUIRE(...) SUREFOOT_THREADS(acquire_capability(__VA_ARGS__))
#define TRY_ACQUIRE(...) SUREFOOT_THREADS(try_acquire_capability(__VA_ARGS__))
#define RELEASE(...) SUREFOOT_THREADS(release_capability(__VA_ARGS__))
#define ASSERT_CAPABILITY(x) SUREFOOT_THREADS(assert_capability(x))
#define NO_THREAD_SAFETY_ANALYSIS SUREFOOT_THREADS(no_thread_safety_analysis)

namespace surefoot {

/// A part that one thread plays, such as a ring's producer: what only that thread may touch is GUARDED_BY its role. Nothing at
/// run time; empty, so it takes no room as a [[no_unique_address]] member.
class CAPABILITY("thread role") ThreadRole {
public:
    /// The calling thread plays the part from here to the end of the function: a claim that callers answer for.
    void plays() const ASSERT_CAPABILITY(this) {}
};

}  // namespace surefoot
