// Annotations for clang's -Wthread-safety, which checks who may access what. Empty for other compilers.
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

/// The role of one thread, such as the producer of a ring. Data that only this thread may access is GUARDED_BY the role.
/// No effect at run time; takes no room as a [[no_unique_address]] member.
class CAPABILITY("thread role") ThreadRole {
public:
    /// Asserts that the calling thread has the role, to the end of the function. The caller is responsible for that.
    void plays() const ASSERT_CAPABILITY(this) {}
};

}  // namespace surefoot
