#include "client/viewer/world/run_control.h"

#include <algorithm>
#include <utility>

namespace evod::viewer {

void RunControl::begin_run(const std::string& world, const std::string& run_id) {
    if (world != world_ || run_id != run_id_) {
        const unsigned unanswered_count = unanswered_count_;
        *this = RunControl{};
        unanswered_count_ = unanswered_count;
        world_ = world;
        run_id_ = run_id;
    }
}

void RunControl::take(const evod::v1::Speed& speed) {
    speed_ = speed;
    if (speed.has_real_time_factor()) {
        factor_ = speed.real_time_factor();
    }
}

void RunControl::update(const evod::v1::SnapshotFrame& snapshot) {
    begin_run(snapshot.world(), snapshot.run_id());
    tick_ = is_replay_ ? snapshot.tick() : std::max(tick_, snapshot.tick());
    // A snapshot older than the last answer or event is outdated. While a request is unanswered, its answer will be
    // newer than the snapshot.
    const bool newer = snapshot.tick() > info_.tick() || state_ == evod::v1::RUN_STATE_UNSPECIFIED;
    if (snapshot.generation() != awaited_fitness_.generation()) {
        awaited_fitness_.Clear(); // another generation has begun
    }
    if (newer && unanswered_count_ == 0) {
        state_ = snapshot.state();
        take(snapshot.speed());
    }
}

void RunControl::update(const evod::v1::WorldInfo& world) {
    begin_run(world.name(), world.run_id());
    is_replay_ = world.has_replay();
    if (world.tick() < info_.tick() && !is_replay_) {
        return; // older than the known state
    }
    tick_ = is_replay_ ? world.tick() : std::max(tick_, world.tick());
    info_ = world;
    awaited_fitness_ = world.awaited_fitness();
    if (unanswered_count_ == 0) {
        state_ = world.state();
        outcome_ = world.outcome();
        take(world.speed());
        step_target_ = state_ == evod::v1::RUN_STATE_RUNNING ? world.run_until_tick() : 0;
        nothing_to_resume_ = nothing_to_resume_ && !(state_ == evod::v1::RUN_STATE_RUNNING && step_target_ == 0);
    }
}

void RunControl::update(evod::v1::AwaitedFitness awaited) {
    if (awaited.generation() >= awaited_fitness_.generation()) { // an event about a command may arrive late
        awaited_fitness_ = std::move(awaited);
    }
}

std::optional<evod::v1::Request> RunControl::pause_or_resume() {
    evod::v1::Request request;
    switch (state_) {
    case evod::v1::RUN_STATE_RUNNING:
        request.mutable_pause()->set_world(world_);
        state_ = evod::v1::RUN_STATE_PAUSED;
        pausing_ = true;
        break;
    case evod::v1::RUN_STATE_PAUSED:
        if (nothing_to_resume_) {
            request.mutable_run()->set_world(world_);
            state_ = evod::v1::RUN_STATE_RUNNING;
            break;
        }
        request.mutable_resume()->set_world(world_);
        state_ = evod::v1::RUN_STATE_RUNNING;
        resuming_ = true;
        break;
    case evod::v1::RUN_STATE_WAITING:
        request.mutable_run()->set_world(world_);
        state_ = evod::v1::RUN_STATE_RUNNING;
        break;
    default:
        return std::nullopt;
    }
    step_target_ = 0;
    held_step_ = 0;
    nothing_to_resume_ = false;
    ++unanswered_count_;
    return request;
}

std::optional<evod::v1::Request> RunControl::step(std::uint64_t ticks) {
    if (state_ == evod::v1::RUN_STATE_UNSPECIFIED || state_ == evod::v1::RUN_STATE_TERMINATED) {
        return std::nullopt;
    }
    if (pausing_) {
        held_step_ += ticks; // the tick at which the world stops is known only from the answer
        return std::nullopt;
    }
    if (state_ == evod::v1::RUN_STATE_RUNNING && step_target_ <= tick_) {
        auto pause = pause_or_resume(); // without a pause, the world would run on when the lease of the step ends
        held_step_ = ticks;
        return pause;
    }
    nothing_to_resume_ = nothing_to_resume_ || state_ == evod::v1::RUN_STATE_WAITING;
    step_target_ = std::max(step_target_, tick_) + ticks;
    evod::v1::Request request;
    request.mutable_run_until_tick()->set_world(world_);
    request.mutable_run_until_tick()->set_tick(step_target_);
    ++unanswered_count_;
    return request;
}

std::optional<evod::v1::Request> RunControl::request_speed(evod::v1::Speed speed) {
    if (!known()) {
        return std::nullopt;
    }
    speed_ = speed;
    evod::v1::Request request;
    request.mutable_set_speed()->set_world(world_);
    *request.mutable_set_speed()->mutable_speed() = std::move(speed);
    ++unanswered_count_;
    return request;
}

std::optional<evod::v1::Request> RunControl::at_factor(double factor) {
    factor_ = std::clamp(factor, factor_min, factor_max);
    evod::v1::Speed speed;
    speed.set_real_time_factor(factor_);
    return request_speed(speed);
}

std::optional<evod::v1::Request> RunControl::faster() {
    return speed_.max() ? std::nullopt : at_factor(factor_ * 2);
}

std::optional<evod::v1::Request> RunControl::slower() {
    return at_factor(speed_.max() ? factor_ : factor_ / 2);
}

std::optional<evod::v1::Request> RunControl::real_time() {
    return at_factor(1);
}

std::optional<evod::v1::Request> RunControl::max_speed() {
    if (speed_.max()) {
        return at_factor(factor_);
    }
    evod::v1::Speed speed;
    speed.set_max(true);
    return request_speed(speed);
}

std::optional<evod::v1::Request> RunControl::run_generations(std::uint64_t generations) {
    if (state_ == evod::v1::RUN_STATE_UNSPECIFIED || state_ == evod::v1::RUN_STATE_TERMINATED) {
        return std::nullopt;
    }
    evod::v1::Request request;
    request.mutable_run()->set_world(world_);
    request.mutable_run()->set_generations(generations);
    state_ = evod::v1::RUN_STATE_RUNNING;
    step_target_ = held_step_ = 0;
    ++unanswered_count_;
    return request;
}

std::optional<evod::v1::Request> RunControl::reset(std::optional<std::uint64_t> seed) {
    if (!known()) {
        return std::nullopt;
    }
    evod::v1::Request request;
    request.mutable_reset_world()->set_world(world_);
    if (seed) {
        request.mutable_reset_world()->set_seed(*seed);
    }
    step_target_ = held_step_ = 0;
    ++unanswered_count_;
    return request;
}

std::optional<evod::v1::Request> RunControl::answered(const evod::v1::Response* response) {
    unanswered_count_ -= unanswered_count_ > 0;
    const bool resumed = resuming_ && unanswered_count_ == 0;
    resuming_ = resuming_ && !resumed;
    pausing_ = pausing_ && unanswered_count_ > 0;
    const std::uint64_t step_ticks = pausing_ ? 0 : std::exchange(held_step_, 0);
    if (response == nullptr || response->status().code() != evod::v1::CODE_UNSPECIFIED || !response->has_world()) {
        // The server did not perform the command, or its outcome is unknown, so request the state.
        if (!known()) {
            return std::nullopt;
        }
        state_ = evod::v1::RUN_STATE_UNSPECIFIED;
        evod::v1::Request request;
        request.mutable_get_statistics()->set_world(world_);
        return request;
    }
    const evod::v1::WorldInfo& world = response->world();
    // The server answers only after it has written the command to disk. An event about the effect may therefore have
    // arrived earlier.
    const bool is_older = info_.run_id() == world.run_id() && info_.tick() > world.tick() && !is_replay_;
    update(is_older ? evod::v1::WorldInfo{info_} : world);
    if (step_ticks > 0) {
        return step(step_ticks);
    }
    // A world that was only stepped has no run to resume, so run it instead.
    return resumed && state_ == evod::v1::RUN_STATE_WAITING ? pause_or_resume() : std::nullopt;
}

} // namespace evod::viewer
