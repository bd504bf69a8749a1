// Debounce of one contact: asserted at its first edge, released after it was stable; lost edges are found and counted. Pure.
//
// Assertion is never delayed, because the delay would make every stop late. The kernel's debounce is not used: it runs
// in jiffies, and stamps an edge after its debounce time.
#pragma once

#include <cstdint>

namespace surefoot::input {

/// State of one debounced contact.
struct Contact {
    bool level = false;              ///< newest raw level, true: asserted
    bool asserted = false;           ///< debounced
    std::int64_t released_ns = -1;   ///< when the raw level of an asserted contact was released; -1: it is not
    std::uint32_t presses = 0;       ///< counts asserting edges after debounce
    std::uint32_t raw_releases = 0;  ///< counts releasing edges without debounce; a dead-man stops at these
    std::uint64_t lost_edges = 0;    ///< found by reading the level again
};

/// Ends the debounce of a release; call at every tick.
inline void release_when_due(Contact& c, std::int64_t debounce_ns, std::int64_t now_ns) {
    if (c.asserted && c.released_ns >= 0 && now_ns - c.released_ns >= debounce_ns) {
        c.asserted = false;
        c.released_ns = -1;
    }
}

/// An edge to `level` at `stamp_ns`. If the contact already has this level, the edge in between was lost.
inline void edge(Contact& c, bool level, std::int64_t stamp_ns, std::int64_t debounce_ns) {
    release_when_due(c, debounce_ns, stamp_ns);
    if (level == c.level) {
        ++c.lost_edges;
        // The lost edge went the other way. So even a short assertion counts, as of a stop.
        if (level)
            ++c.raw_releases;
        else
            ++c.presses;
    }
    c.level = level;
    if (level) {
        if (!c.asserted) ++c.presses;
        c.asserted = true;
        c.released_ns = -1;
    } else {
        ++c.raw_releases;
        if (c.asserted) c.released_ns = stamp_ns;
    }
}

/// The level, read again after a burst of edges. Repairs edges that the kernel's full queue has dropped.
inline void reread(Contact& c, bool level, std::int64_t now_ns, std::int64_t debounce_ns) {
    if (level != c.level) {
        ++c.lost_edges;
        c.level = !level;  // as before the lost edge
        edge(c, level, now_ns, debounce_ns);
    }
    release_when_due(c, debounce_ns, now_ns);
}

}  // namespace surefoot::input
