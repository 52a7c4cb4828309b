// WorldView: the latest two pictures of an island, and where everyone stands between them.
//
// Pictures come 20 or 30 times a second, a screen is drawn 60 times. What is drawn lies one picture behind: while the
// newest picture is on its way in, organisms move from where the one before showed them to where it shows them.
//
// Owner        a viewer, one for each island it shows.
// Threads      none; used by the thread that draws.
#pragma once

#include "proto/codec/snapshot_codec.h"

#include <chrono>
#include <memory>
#include <vector>

namespace evod::core {

class WorldView {
  public:
    using Clock = std::chrono::steady_clock;

    /// Centres, index by index those of latest()->organisms or ->crates.
    struct Positions {
        std::vector<float> x_px, y_px;
    };

    /// Pictures more simulated seconds apart than this are not blended: the straight way between them means nothing.
    /// 60 times as fast as real time, at 30 pictures a second.
    static constexpr double blended_s_max = 2;
    /// The way from one picture to the next takes as long as lay between their arrivals, and no longer than this: a
    /// world that was paused shows its next tick now.
    static constexpr std::chrono::duration<double> glide_max{0.25};

    /// A picture of another run, generation or time back stands alone: nobody glides from one life to the next. One of
    /// the same tick, in which more or something else is seen, takes the place of the latest.
    void add(std::shared_ptr<const codec::DecodedSnapshot> picture, Clock::time_point arrived);

    /// Forgets everything: another world or island is shown.
    void clear();

    /// Null before the first.
    const std::shared_ptr<const codec::DecodedSnapshot>& latest() const { return latest_; }
    /// Null if the latest stands alone.
    const std::shared_ptr<const codec::DecodedSnapshot>& previous() const { return previous_; }

    /// How far between previous() and latest() the moment `now` lies, 0 to 1; 1 if the latest stands alone.
    double blend_at(Clock::time_point now) const;

    /// Where the organisms and crates of latest() are drawn at a blend. One that previous() does not have
    /// stands where latest() shows it. Valid until the next call of this object.
    const Positions& organisms_at(double blend);
    const Positions& crates_at(double blend);

  private:
    std::shared_ptr<const codec::DecodedSnapshot> latest_, previous_;
    Clock::time_point latest_arrived_{};
    std::chrono::duration<double> glide_{0}; // how long the way from one to the other takes
    // By index in latest_: index in previous_, or npos.
    std::vector<std::size_t> match_, crate_match_;
    Positions organisms_, crates_;
};

} // namespace evod::core
