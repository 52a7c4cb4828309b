// Motion history: the answers to GetMotion for one island, newest last, and whether the tick is short enough.
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

    /// Replaces the last entry if it has the same tick. A tick before the last one clears the history first.
    void add(const evod::v1::Motion& motion);
    void clear() { motions_.clear(); }

    bool empty() const { return motions_.empty(); }
    std::size_t size() const { return motions_.size(); }
    const evod::v1::Motion& last() const { return motions_.back(); }
    /// `of` applied to every entry, oldest first.
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

/// Whether a tick is short enough for the current speeds, and what to change if not.
struct TickVerdict {
    enum class Level { Good, Close, TooLong };
    Level level = Level::Good;
    std::string sentence;
};
TickVerdict judge_tick(const evod::v1::Motion& motion);

} // namespace evod::viewer
