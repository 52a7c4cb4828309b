// Motion history: stores the answers to GetMotion for one island, oldest first, and decides whether the tick is short
// enough.
//
// Owner        PhysicsPanel.
// Threads      none.
#pragma once

#include "evod/v1/commands.pb.h"

#include <cstddef>
#include <deque>
#include <string>
#include <vector>

namespace evod::viewer {

class MotionHistory {
  public:
    static constexpr std::size_t kept = 300;

    /// Adds an answer. Replaces the last entry if that has the same tick. If the tick is earlier than that of the last
    /// entry, clears the history first.
    void add(const evod::v1::Motion& motion);
    void clear() { motions_.clear(); }

    bool empty() const { return motions_.empty(); }
    std::size_t size() const { return motions_.size(); }
    const evod::v1::Motion& last() const { return motions_.back(); }
    /// Returns the results of applying the function `of` to every entry, oldest first.
    template <class Of>
    std::vector<double> curve(Of&& of) const {
        std::vector<double> curve;
        for (const evod::v1::Motion& motion : motions_) {
            curve.push_back(of(motion));
        }
        return curve;
    }

  private:
    std::deque<evod::v1::Motion> motions_;
};

/// States whether a tick is short enough for the current speeds, and if not, what to change.
struct TickVerdict {
    enum class Level { Good, Close, TooLong };
    Level level = Level::Good;
    std::string sentence;
};
TickVerdict judge_tick(const evod::v1::Motion& motion);

} // namespace evod::viewer
