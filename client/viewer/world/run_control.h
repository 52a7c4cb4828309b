// RunControl: the state of a world as known to this client, and the requests that command its run.
//
// The state comes from snapshots, which arrive many times per second, and from answers and events that contain a
// WorldInfo. Until a request is answered, its effect is assumed. If a key is pressed again before the answer arrives,
// it therefore acts on the state that the window shows.
//
// It has more than 30 members: a function for each command, and a value for each effect that is assumed.
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
    /// Clears everything. Call when another world is viewed or the world was deleted.
    void forget() { *this = RunControl{}; }

    void update(const evod::v1::SnapshotFrame& snapshot);
    void update(const evod::v1::WorldInfo& world);
    /// Takes an event about the fitness for which the viewed world waits; without islands, it waits no longer.
    void update(evod::v1::AwaitedFitness awaited);

    // The following functions create requests. The caller must send each returned request and call answered() exactly
    // once for it.

    /// Pauses a running world and resumes a paused one. A world that waits, or was stepped while it waited, starts to
    /// run until it is paused. Returns nullopt if the run has ended or its state is unknown.
    std::optional<evod::v1::Request> pause_or_resume();
    /// Steps `ticks` beyond the current tick, or beyond the target of an unfinished step. A running world is paused
    /// first. Returns nullopt if the run has ended, if its state is unknown, or while a pause is unanswered; in this
    /// last case answered() returns the step later.
    std::optional<evod::v1::Request> step(std::uint64_t ticks);
    /// faster() doubles the speed, slower() halves it. From the maximum speed, slower() returns to the previous speed.
    std::optional<evod::v1::Request> faster();
    std::optional<evod::v1::Request> slower();
    std::optional<evod::v1::Request> real_time();
    /// Sets the speed to `factor` times real time, clamped to factor_min to factor_max.
    std::optional<evod::v1::Request> at_factor(double factor);
    /// Sets the maximum speed. If it is already set, returns to the previous speed.
    std::optional<evod::v1::Request> max_speed();

    /// Runs `generations` (>= 1) more generations; then the world waits. Returns nullopt if the run has ended or its
    /// state is unknown.
    std::optional<evod::v1::Request> run_generations(std::uint64_t generations);
    /// Restarts the run from its beginning, with the same seed if `seed` is nullopt. Returns nullopt if the world is
    /// unknown.
    std::optional<evod::v1::Request> reset(std::optional<std::uint64_t> seed);

    /// Processes the answer to a request; null: no answer will arrive. Returns a request to send next, or nullopt.
    std::optional<evod::v1::Request> answered(const evod::v1::Response* response);

    bool known() const { return !world_.empty(); }
    const std::string& world() const { return world_; }
    const std::string& run_id() const { return run_id_; }
    std::uint64_t tick() const { return tick_; }
    evod::v1::RunState state() const { return state_; }
    const evod::v1::Speed& speed() const { return speed_; }
    evod::v1::Outcome outcome() const { return outcome_; }
    /// Returns the newest WorldInfo; empty before the first one arrives. Snapshots may be of later ticks.
    const evod::v1::WorldInfo& info() const { return info_; }

    /// Returns the fitness for which the world waits; nullptr if it waits for none.
    const evod::v1::AwaitedFitness* awaited_fitness() const {
        return awaited_fitness_.islands().empty() ? nullptr : &awaited_fitness_;
    }

    static constexpr double factor_min = 0.001,
                            factor_max = 10'000; // in multiples of real time; range allowed by the server

  private:
    void begin_run(const std::string& world, const std::string& run_id);
    void take(const evod::v1::Speed& speed);
    std::optional<evod::v1::Request> request_speed(evod::v1::Speed speed);

    std::string world_, run_id_;
    std::uint64_t tick_ = 0;        // newest known tick
    std::uint64_t step_target_ = 0; // target tick of an unfinished step; otherwise <= tick_
    bool is_replay_ = false;        // in a replay, a seek may decrease the tick
    evod::v1::RunState state_ = evod::v1::RUN_STATE_UNSPECIFIED;
    evod::v1::Outcome outcome_ = evod::v1::OUTCOME_UNSPECIFIED;
    evod::v1::Speed speed_;
    evod::v1::WorldInfo info_;
    evod::v1::AwaitedFitness awaited_fitness_; // without islands: the world waits for none
    double factor_ = 1;                        // the last speed other than the maximum
    unsigned unanswered_count_ = 0;
    bool resuming_ = false;          // a Resume request is unanswered
    bool pausing_ = false;           // a Pause request is unanswered
    std::uint64_t held_step_ = 0;    // ticks to step after the answer to Pause
    bool nothing_to_resume_ = false; // the world was waiting when it was stepped
};

} // namespace evod::viewer
