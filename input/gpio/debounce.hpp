// One contact: asserted at its first edge, released once it has kept still, with lost edges found and counted. Pure.
//
// Never the other way round: a switch that is asserted late is a walk that stops late. Kernel debounce runs in jiffies and stamps
// after its settle time (devices.md F7), so it is not used.
#pragma once

#include <cstdint>

namespace surefoot::input {

struct Contact {
    bool level = false;              ///< newest raw level, true: asserted
    bool asserted = false;           ///< debounced
    std::int64_t released_ns = -1;   ///< since when the raw level of an asserted contact has been released; -1: it is not
    std::uint32_t presses = 0;       ///< counts asserting edges after debounce
    std::uint32_t raw_releases = 0;  ///< counts releasing edges, undebounced: what a dead-man stops by
    std::uint64_t lost_edges = 0;    ///< found by reading the level again
};

/// The release settles; call at every tick.
inline void settle(Contact& c, std::int64_t settle_ns, std::int64_t now_ns) {
    if (c.asserted && c.released_ns >= 0 && now_ns - c.released_ns >= settle_ns) {
        c.asserted = false;
        c.released_ns = -1;
    }
}

/// An edge to `level` at `stamp_ns`. An edge to the level that it already has means that the one between was lost.
inline void edge(Contact& c, bool level, std::int64_t stamp_ns, std::int64_t settle_ns) {
    settle(c, settle_ns, stamp_ns);
    if (level == c.level) {
        ++c.lost_edges;
        // The lost one went the other way; a stop that was asserted for a moment was asserted.
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

/// The level as read again after a burst of edges: repairs what the kernel's full queue has dropped (devices.md F6).
inline void reread(Contact& c, bool level, std::int64_t now_ns, std::int64_t settle_ns) {
    if (level != c.level) {
        ++c.lost_edges;
        c.level = !level;  // as before the lost edge
        edge(c, level, now_ns, settle_ns);
    }
    settle(c, settle_ns, now_ns);
}

}  // namespace surefoot::input
