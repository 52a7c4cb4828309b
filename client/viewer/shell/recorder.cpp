#include "client/viewer/shell/recorder.h"

#include "client/core/duration.h"
#include "client/viewer/panes/window_renderer.h"
#include "client/viewer/shell/frame_writer.h"
#include "client/viewer/shell/snapshot_wait.h"
#include "client/viewer/shell/window.h"
#include "client/viewer/world/status_text.h"

#include <SFML/Window/Context.hpp>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <iostream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

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
        , panes_{wanted_of(options, snapshot_rate_hz), options.beside, view_of(options)} {}

    void run() {
        if (wait_until([&] { return all_have_snapshots(panes_); }, true)) {
            try {
                if (pause_worlds()) {
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
                      << (leader().commands.may_command() ? "another client ran the world meanwhile"
                                                          : "a viewer cannot step the world")
                      << '\n';
        }
    }

  private:
    /// Returns the world of the first pane. Its ticks and generations determine when the recording ends.
    ViewedWorld& leader() { return panes_[0].world; }

    void record_all() {
        const evod::v1::SnapshotFrame& first = leader().feed.snapshot()->about;
        first_tick_ = last_tick_ = first.tick();
        first_generation_ = first.generation();
        do {
            for (std::size_t i = 0; i < panes_.size(); ++i) {
                if (was_reset(i)) {
                    throw std::runtime_error{quoted(panes_[i].world.feed.control().world()) +
                                             " was reset while it was recorded"};
                }
            }
            const evod::v1::SnapshotFrame& shown = leader().feed.snapshot()->about;
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
                             panes_, {.width_pixels = size_.width, .height_pixels = size_.height, .now = Clock::now()}),
                         last_tick_);
            if (wanted_.ticks && last_tick_ >= first_tick_ + *wanted_.ticks) {
                return;
            }
        } while (advance());
    }

    /// Pauses each world that the recorder will step, so that no tick is missed between the first two frames. Returns
    /// false if the recording was interrupted.
    bool pause_worlds() {
        targets_.assign(panes_.size(), 0);
        for (std::size_t i = 0; i < panes_.size(); ++i) {
            ViewedWorld& world = panes_[i].world;
            run_ids_.push_back(world.feed.snapshot()->about.run_id());
            if (world.commands.may_command() && !is_over(world)) {
                step(world, world.feed.snapshot()->about.tick(), i);
            }
        }
        return wait_until([&] { return all_have_snapshots(panes_) && all_at_targets(); }, true);
    }

    /// Advances every world to its next frame. Returns false if the leader has no further tick or the recording was
    /// interrupted.
    bool advance() {
        targets_.assign(panes_.size(), 0); // the tick for which each pane waits
        for (std::size_t i = 0; i < panes_.size(); ++i) {
            ViewedWorld& world = panes_[i].world;
            const std::uint64_t tick = world.feed.snapshot()->about.tick();
            std::uint64_t target = tick + wanted_.every_ticks;
            if (world.replay.info() != nullptr && world.commands.may_command()) {
                target = std::min(target, world.replay.info()->last_tick());
            }
            if (is_over(world) || target <= tick) {
                if (i == 0) {
                    return false;
                }
            } else if (world.commands.may_command()) {
                step(world, target, i);
            } else if (i == 0) {
                targets_[i] = target;
            }
        }
        return wait_until([&] { return all_at_targets(); }, leader().commands.may_command());
    }

    /// Runs a world to a tick and stops it there. If the world has already passed this tick, it only stops. The answer
    /// contains the tick at which it stopped.
    void step(ViewedWorld& world, std::uint64_t tick, std::size_t pane) {
        targets_[pane] = tick;
        evod::v1::Request request;
        request.mutable_run_until_tick()->set_world(world.feed.control().world());
        request.mutable_run_until_tick()->set_tick(tick);
        world.server.send(std::move(request), [this, &world, pane](const core::Result<evod::v1::Response>& response) {
            if (!response) {
                refusal_ = response.error().what;
            } else if (!core::accepted(*response) && !is_over(world)) {
                refusal_ = refusal_text(response->status());
            } else {
                targets_[pane] = std::max(targets_[pane], response->world().tick());
            }
        });
    }

    bool was_reset(std::size_t pane) {
        const codec::ReceivedSnapshot* snapshot = panes_[pane].world.feed.snapshot();
        return snapshot != nullptr && snapshot->about.run_id() != run_ids_[pane];
    }

    bool all_at_targets() {
        for (std::size_t i = 0; i < panes_.size(); ++i) {
            const std::vector<Tile> tiles = panes_[i].tiles();
            const bool arrived = std::ranges::all_of(tiles, [&](const Tile& tile) {
                const auto& snapshot = tile.view.latest();
                return snapshot && snapshot->about.tick() >= targets_[i];
            });
            if (!arrived && !is_over(panes_[i].world) && !was_reset(i)) {
                return false;
            }
        }
        return true;
    }

    /// Waits until the condition holds. Returns false if the recording was interrupted.
    template <class Condition>
    bool wait_until(Condition condition, bool limited) {
        const auto end = Clock::now() +
                         std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>{wanted_.timeout_s});
        while (true) {
            panes_.update(Clock::now());
            if (condition()) {
                return true;
            }
            for (std::size_t i = 0; i < panes_.size(); ++i) {
                check_reachable(panes_[i].world);
            }
            if (!refusal_.empty()) {
                throw std::runtime_error{refusal_};
            }
            if (interrupted) {
                return false;
            }
            if (limited && Clock::now() >= end) {
                throw std::runtime_error{"no snapshot arrived within " + core::duration(wanted_.timeout_s) + ": " +
                                         progress_text(leader())};
            }
            std::this_thread::sleep_for(poll_interval);
        }
    }

    /// Releases the leases. Worlds that were running before the recording then resume at once; otherwise they would
    /// resume only when their leases expire.
    void release() {
        for (std::size_t i = 0; i < panes_.size(); ++i) {
            ViewedWorld& world = panes_[i].world;
            if (world.commands.may_command() && world.replay.info() == nullptr) {
                evod::v1::Request request;
                request.mutable_release_lease()->set_world(world.feed.control().world());
                world.server.send(std::move(request),
                                  [](const auto&) {}); // a refusal is ignored, because there was no lease
            }
        }
        const auto end = Clock::now() + release_timeout;
        for (std::size_t i = 0; i < panes_.size(); ++i) {
            while (!panes_[i].world.all_answered() && Clock::now() < end) {
                std::this_thread::sleep_for(poll_interval);
                panes_[i].world.update(Clock::now());
            }
        }
    }

    const Options::Record& wanted_;
    double scale_;
    Options::Size size_;
    std::unique_ptr<FrameWriter> writer_; // opened before panes_, so that a failure leaves the worlds unchanged
    WindowRenderer renderer_{scale_};
    Panes panes_;
    std::vector<std::uint64_t> targets_;
    std::vector<std::string> run_ids_; // run id of each pane's world
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
