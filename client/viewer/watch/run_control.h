// Run control: what a world is doing, as far as is known here, and the request that a key stands for.
//
// Two things tell of a world's state: pictures, many a second, and the answers and events that carry a WorldInfo. What
// was asked is taken as done until its answer comes, so that a second press of a key means what the person sees.
//
// Threads      none.
#pragma once

#include "evod/v1/session.pb.h"

#include <cstdint>
#include <optional>
#include <string>

namespace evod::viewer {

class RunControl {
  public:
    /// Another world is watched, or a server that forgot this one.
    void forget() { *this = RunControl{}; }

    void see(const evod::v1::SnapshotFrame& picture);
    void see(const evod::v1::WorldInfo& world);

    // What a key asks for. Every request that is returned must be followed by one answered(), whatever came of it.

    /// Running: pause; paused: go on; waiting, or stepped from there: run until paused. Nullopt when the run has ended,
    /// or nothing is known yet.
    std::optional<evod::v1::Request> pause_or_resume();
    /// So many ticks more than there are, or than an unfinished step has asked for. A world that runs is paused first.
    /// Nullopt as above, and while a pause is unanswered: answered() then returns the step.
    std::optional<evod::v1::Request> step(std::uint64_t ticks);
    /// Twice or half the speed; down from the highest is the speed before.
    std::optional<evod::v1::Request> faster();
    std::optional<evod::v1::Request> slower();
    std::optional<evod::v1::Request> real_time();
    /// So many times real time; put within factor_min and factor_max.
    std::optional<evod::v1::Request> at_factor(double factor);
    /// The highest, or if it is that already, the speed before.
    std::optional<evod::v1::Request> max_speed();

    /// So many generations more, >= 1, then wait. Nullopt when the run has ended, or nothing is known yet.
    std::optional<evod::v1::Request> run_generations(std::uint64_t generations);
    /// The run from its beginning; without a seed, with the same again. Nullopt while nothing is known.
    std::optional<evod::v1::Request> reset(std::optional<std::uint64_t> seed);

    /// An answer has come, or none ever will (null). Returns a request that is needed to end what was begun.
    std::optional<evod::v1::Request> answered(const evod::v1::Response* response);

    bool known() const { return !world_.empty(); }
    const std::string& world() const { return world_; }
    const std::string& run_id() const { return run_id_; }
    std::uint64_t tick() const { return tick_; }
    /// Whether it runs to a tick that was named, and pauses there.
    bool stepping() const { return step_target_ > tick_; }
    evod::v1::RunState state() const { return state_; }
    const evod::v1::Speed& speed() const { return speed_; }
    evod::v1::Outcome outcome() const { return outcome_; }
    /// The newest WorldInfo; empty before the first. Pictures know of later ticks.
    const evod::v1::WorldInfo& told() const { return told_; }

    static constexpr double factor_min = 0.001, factor_max = 10'000; // of real time, as the server takes them

  private:
    void begin_run(const std::string& world, const std::string& run_id);
    void take(const evod::v1::Speed& speed);
    std::optional<evod::v1::Request> ask_for(evod::v1::Speed speed);

    std::string world_, run_id_;
    std::uint64_t tick_ = 0;        // the newest known
    std::uint64_t step_target_ = 0; // of an unfinished step; else in the past
    bool shows_past_ = false;       // its ticks may fall
    evod::v1::RunState state_ = evod::v1::RUN_STATE_UNSPECIFIED;
    evod::v1::Outcome outcome_ = evod::v1::OUTCOME_UNSPECIFIED;
    evod::v1::Speed speed_;
    evod::v1::WorldInfo told_;
    double factor_ = 1; // the last that was not max
    unsigned unanswered_count_ = 0;
    bool resuming_ = false;          // a Resume is among the unanswered
    bool pausing_ = false;           // a Pause is
    std::uint64_t held_step_ = 0;    // ticks to step when the Pause is answered
    bool nothing_to_resume_ = false; // it had come to its goal before it was stepped
};

} // namespace evod::viewer
