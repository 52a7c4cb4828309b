#include "client/viewer/shell/recorder.h"

#include "client/core/duration.h"
#include "client/viewer/shell/frame_writer.h"
#include "client/viewer/shell/snapshot_wait.h"
#include "client/viewer/shell/window.h"
#include "client/viewer/view/window_renderer.h"
#include "client/viewer/world/status_text.h"

#include <SFML/Window/Context.hpp>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <iostream>
#include <stdexcept>
#include <string>
#include <thread>

namespace evod::viewer {

namespace {

using Clock = core::SnapshotInterpolator::Clock;

constexpr double snapshot_rate_hz =
    60; // snapshots per second, for worlds that are not stepped; a stepped world sends one at the end of each step
constexpr std::chrono::seconds release_timeout{2};

volatile std::sig_atomic_t interrupted = 0;

bool is_over(const ViewedWorld& world) {
    return world.feed.control().state() == evod::v1::RUN_STATE_TERMINATED;
}

class Recorder {
  public:
    Recorder(const Options& options, const Options::Record& wanted)
        : wanted_{wanted}
        , scale_{options.scale.value_or(1)} // independent of any display
        , size_{size_of(options, scale_)}
        , writer_{open_frame_writer(wanted.path, size_.width, size_.height, wanted.fps)}
        , view_{wanted_of(options, snapshot_rate_hz), view_of(options)} {}

    void run() {
        if (wait_until([&] { return has_all_snapshots(view_); }, true)) {
            try {
                if (pause_world()) {
                    record_all();
                }
            } catch (...) {
                release();
                throw;
            }
            release();
        }
        writer_->finish();
        std::cout << wanted_.path << ": " << writer_->frame_count() << " frames, ticks " << first_tick_ << " to "
                  << last_tick_ << '\n';
        if (missed_ticks_ > 0) {
            std::cerr << "evoview: " << missed_ticks_ << " ticks in between were missed: "
                      << (world().commands.may_command() ? "another client ran the world meanwhile"
                                                         : "a viewer cannot step the world")
                      << '\n';
        }
    }

  private:
    void record_all() {
        const evod::v1::SnapshotFrame& first = world().feed.snapshot()->about;
        first_tick_ = last_tick_ = first.tick();
        first_generation_ = first.generation();
        do {
            if (was_reset()) {
                throw std::runtime_error{quoted(world().feed.control().world()) + " was reset while it was recorded"};
            }
            const evod::v1::SnapshotFrame& shown = world().feed.snapshot()->about;
            if (wanted_.generations && shown.generation() >= first_generation_ + *wanted_.generations) {
                return;
            }
            if (writer_->frame_count() > 0 && shown.tick() == last_tick_) {
                continue; // the world ended at this tick
            }
            if (writer_->frame_count() > 0 && shown.tick() > last_tick_ + wanted_.every_ticks) {
                missed_ticks_ += shown.tick() - last_tick_ - wanted_.every_ticks;
            }
            last_tick_ = shown.tick();
            writer_->add(renderer_.capture(
                             view_, {.width_pixels = size_.width, .height_pixels = size_.height, .now = Clock::now()}),
                         last_tick_);
            if (wanted_.ticks && last_tick_ >= first_tick_ + *wanted_.ticks) {
                return;
            }
        } while (advance());
    }

    /// Pauses the world if the recorder will step it, so that no tick is missed between the first two frames. Returns
    /// false if the recording was interrupted.
    bool pause_world() {
        run_id_ = world().feed.snapshot()->about.run_id();
        if (world().commands.may_command() && !is_over(world())) {
            step(world().feed.snapshot()->about.tick());
        }
        return wait_until([&] { return has_all_snapshots(view_) && is_at_target(); }, true);
    }

    /// Advances the world to its next frame. Returns false if the world has no further tick or the recording was
    /// interrupted.
    bool advance() {
        const std::uint64_t tick = world().feed.snapshot()->about.tick();
        std::uint64_t target = tick + wanted_.every_ticks;
        const bool may_command = world().commands.may_command();
        if (world().replay.info() != nullptr && may_command) {
            target = std::min(target, world().replay.info()->last_tick());
        }
        if (is_over(world()) || target <= tick) {
            return false;
        }
        target_ = target;
        if (may_command) {
            step(target);
        }
        return wait_until([&] { return is_at_target(); }, may_command);
    }

    /// Runs the world to a tick and stops it there. If the world has already passed this tick, it only stops. The
    /// answer contains the tick at which it stopped.
    void step(std::uint64_t tick) {
        target_ = tick;
        evod::v1::Request request;
        request.mutable_run_until_tick()->set_world(world().feed.control().world());
        request.mutable_run_until_tick()->set_tick(tick);
        world().server.send(std::move(request), [this](const core::Result<evod::v1::Response>& response) {
            if (!response) {
                refusal_ = response.error().what;
            } else if (!core::accepted(*response) && !is_over(world())) {
                refusal_ = refusal_text(response->status());
            } else {
                target_ = std::max(target_, response->world().tick());
            }
        });
    }

    bool was_reset() {
        const codec::ReceivedSnapshot* snapshot = world().feed.snapshot();
        return snapshot != nullptr && snapshot->about.run_id() != run_id_;
    }

    bool is_at_target() {
        const bool arrived = std::ranges::all_of(view_.tiles(), [&](const Tile& tile) {
            return tile.view.latest() && tile.view.latest()->about.tick() >= target_;
        });
        return arrived || is_over(world()) || was_reset();
    }

    /// Waits until the condition holds. Returns false if the recording was interrupted.
    template <class Condition>
    bool wait_until(Condition condition, bool limited) {
        const auto end = Clock::now() +
                         std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>{wanted_.timeout_s});
        while (true) {
            world().update(Clock::now());
            if (condition()) {
                return true;
            }
            check_reachable(world());
            if (!refusal_.empty()) {
                throw std::runtime_error{refusal_};
            }
            if (interrupted) {
                return false;
            }
            if (limited && Clock::now() >= end) {
                throw std::runtime_error{"no snapshot arrived within " + core::duration(wanted_.timeout_s) + ": " +
                                         progress_text(world())};
            }
            std::this_thread::sleep_for(poll_interval);
        }
    }

    /// Releases the lease. If the world was running before the recording, it resumes at once; otherwise it would resume
    /// only when the lease expires.
    void release() {
        if (world().commands.may_command() && world().replay.info() == nullptr) {
            evod::v1::Request request;
            request.mutable_release_lease()->set_world(world().feed.control().world());
            // A refusal is ignored, because there was no lease.
            world().server.send(std::move(request), [](const auto&) {});
        }
        const auto end = Clock::now() + release_timeout;
        while (!world().all_answered() && Clock::now() < end) {
            std::this_thread::sleep_for(poll_interval);
            world().update(Clock::now());
        }
    }

    ViewedWorld& world() { return view_.world; }

    const Options::Record& wanted_;
    double scale_;
    Options::Size size_;
    std::unique_ptr<FrameWriter> writer_; // opened before view_, so that a failure leaves the world unchanged
    WindowRenderer renderer_{scale_};
    WorldView view_;
    std::uint64_t target_ = 0; // the tick for which the recorder waits
    std::string run_id_;
    std::string refusal_;
    std::uint64_t first_tick_ = 0, last_tick_ = 0, first_generation_ = 0, missed_ticks_ = 0;
};

} // namespace

void record(const Options& options, const Options::Record& wanted) {
    sf::Context context{context_settings(), 1, 1};
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        std::signal(signal, [](int) { interrupted = 1; });
    }
    Recorder{options, wanted}.run();
}

} // namespace evod::viewer
