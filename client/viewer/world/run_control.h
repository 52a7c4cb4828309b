// RunControl: the state of a world as far as this client knows it, and the requests that command its run.
//
// The state comes from two sources: snapshots, many a second, and answers and events that contain a WorldInfo. The
// effect of a request is assumed until its answer arrives, so that a second press of a key acts on what the window
// shows.
//
// Owner        WorldFeed.
// Threads      none.
#pragma once

#include "evod/v1/session.pb.h"

#include <cstdint>
#include <optional>
#include <string>

namespace evod::viewer {

class RunControl {
  public:
    /// Forgets everything: another world is viewed, or this one was deleted.
    void forget() { *this = RunControl{}; }

    void update(const evod::v1::SnapshotFrame& snapshot);
    void update(const evod::v1::WorldInfo& world);

    // Requests. The caller sends each request that is returned, and calls answered() once for it.

    /// A running world is paused; a paused world is resumed; a world that waits, or was stepped while it waited, runs
    /// until it is paused. Nullopt when the run has ended, or nothing is known yet.
    std::optional<evod::v1::Request> pause_or_resume();
    /// Runs `ticks` further than the current tick, or than the target of an unfinished step. A running world is paused
    /// first. Nullopt as above, and while a pause is unanswered: answered() then returns the step.
    std::optional<evod::v1::Request> step(std::uint64_t ticks);
    /// Doubles or halves the speed. From the maximum, slower() returns to the speed before it.
    std::optional<evod::v1::Request> faster();
    std::optional<evod::v1::Request> slower();
    std::optional<evod::v1::Request> real_time();
    /// `factor` times real time, clamped to factor_min and factor_max.
    std::optional<evod::v1::Request> at_factor(double factor);
    /// The maximum speed; if that is set already, the speed before it.
    std::optional<evod::v1::Request> max_speed();

    /// Runs `generations` more, >= 1, then waits. Nullopt when the run has ended, or nothing is known yet.
    std::optional<evod::v1::Request> run_generations(std::uint64_t generations);
    /// Starts the run again from its beginning; without a seed, with the same seed. Nullopt while nothing is known.
    std::optional<evod::v1::Request> reset(std::optional<std::uint64_t> seed);

    /// Takes in the answer to one request; null: no answer will arrive. Returns a request that has to follow it.
    std::optional<evod::v1::Request> answered(const evod::v1::Response* response);

    bool known() const { return !world_.empty(); }
    const std::string& world() const { return world_; }
    const std::string& run_id() const { return run_id_; }
    std::uint64_t tick() const { return tick_; }
    /// Whether the world runs to a given tick and pauses there.
    bool stepping() const { return step_target_ > tick_; }
    evod::v1::RunState state() const { return state_; }
    const evod::v1::Speed& speed() const { return speed_; }
    evod::v1::Outcome outcome() const { return outcome_; }
    /// The newest WorldInfo; empty before the first. Snapshots may be of later ticks.
    const evod::v1::WorldInfo& info() const { return info_; }

    static constexpr double factor_min = 0.001, factor_max = 10'000; // of real time; the range that the server accepts

  private:
    void begin_run(const std::string& world, const std::string& run_id);
    void take(const evod::v1::Speed& speed);
    std::optional<evod::v1::Request> ask_for(evod::v1::Speed speed);

    std::string world_, run_id_;
    std::uint64_t tick_ = 0;        // the newest known
    std::uint64_t step_target_ = 0; // tick of an unfinished step; else not later than tick_
    bool is_replay_ = false;        // a seek may set the tick back
    evod::v1::RunState state_ = evod::v1::RUN_STATE_UNSPECIFIED;
    evod::v1::Outcome outcome_ = evod::v1::OUTCOME_UNSPECIFIED;
    evod::v1::Speed speed_;
    evod::v1::WorldInfo info_;
    double factor_ = 1; // the last speed that was not the maximum
    unsigned unanswered_count_ = 0;
    bool resuming_ = false;          // a Resume is unanswered
    bool pausing_ = false;           // a Pause is unanswered
    std::uint64_t held_step_ = 0;    // ticks to step once the Pause is answered
    bool nothing_to_resume_ = false; // the world was waiting when it was stepped
};

} // namespace evod::viewer
