// Motion history: what GetMotion told of an island, newest last, and what it means for the length of a tick.
//
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

    /// The same tick again is not kept twice; one before the last begins everything anew.
    void add(const evod::v1::Motion& motion);
    void clear() { motions_.clear(); }

    bool empty() const { return motions_.empty(); }
    std::size_t size() const { return motions_.size(); }
    const evod::v1::Motion& last() const { return motions_.back(); }
    /// One number of each, oldest first.
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

/// Whether a tick is short enough for the speeds there are, and what to do if not.
struct TickVerdict {
    enum class Level { Good, Close, TooLong };
    Level level = Level::Good;
    std::string sentence;
};
TickVerdict judge_tick(const evod::v1::Motion& motion);

} // namespace evod::viewer
