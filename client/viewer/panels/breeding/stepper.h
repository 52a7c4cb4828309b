// Stepper: keeps the moment of a breeding that the glass box shows; steps forward and back, plays, and jumps.
//
// The moments are: the fitness and its scaling; each pick; each descendant; the complete next generation.
//
// Owner        BreedingPanel.
// Threads      none.
#pragma once

#include <cstdint>

namespace evod::viewer {

enum class BreedingStage { Scaling, Picking, Breeding, Done };

struct Moment {
    BreedingStage stage = BreedingStage::Scaling;
    std::uint32_t index = 0; // index of the pick or descendant
    friend bool operator==(const Moment&, const Moment&) = default;
};

class Stepper {
  public:
    /// Limits of the playing speed, in steps per second.
    static constexpr double speed_min = 0.25, speed_max = 200;

    /// Loads a breeding and goes to its first moment.
    void load(std::uint32_t picks, std::uint32_t descendants);
    Moment moment() const;

    std::uint32_t position() const { return position_; } // index of the moment, 0 to last_position()
    std::uint32_t last_position() const { return picks_ + descendants_ + 1; }
    bool at_begin() const { return position_ == 0; }
    bool at_end() const { return position_ == last_position(); }

    // The following functions perform the user's moves. Each of them also stops playing.
    void step();
    void back();
    void next_stage();     // goes to the first moment of the next stage
    void previous_stage(); // goes to the first moment of this stage; if already there, of the previous stage
    void to_begin() { go_to(0); }
    void to_end() { go_to(last_position()); }
    void go_to(std::uint32_t position);

    /// Starts or stops playing. At the last moment, playing starts from the first moment.
    void play_or_stop();
    void play();
    bool playing() const { return playing_; }
    void set_speed(double steps_per_s);
    double speed() const { return steps_per_s_; }
    /// While playing, advances by this time. Playing stops at the last moment.
    void advance(double seconds);

  private:
    std::uint32_t begin_of(BreedingStage stage) const;
    void stop();

    std::uint32_t picks_ = 0, descendants_ = 0;
    std::uint32_t position_ = 0;
    bool playing_ = false;
    double steps_per_s_ = 2;
    double due_ = 0; // fraction of the next step that has elapsed, 0 to 1
};

} // namespace evod::viewer
