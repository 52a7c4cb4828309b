#include "client/viewer/shell/recorder.h"

#include "client/core/duration.h"
#include "client/viewer/shell/film.h"
#include "client/viewer/shell/waiting.h"
#include "client/viewer/shell/window.h"
#include "client/viewer/stage/stage.h"
#include "client/viewer/watch/readout.h"

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

using Clock = core::WorldView::Clock;

constexpr double film_rate_hz = 60; // of pictures that come by themselves; the end of a step is shown at once
constexpr std::chrono::seconds give_back_max{2};

volatile std::sig_atomic_t interrupted = 0;

bool is_over(const Watch& watch) {
    return watch.control().state() == evod::v1::RUN_STATE_TERMINATED;
}

class Recorder {
  public:
    Recorder(const Options& options, const Options::Record& wanted)
        : wanted_{wanted}
        , scale_{options.scale.value_or(1)} // a film is on no screen
        , size_{size_of(options, scale_)}
        , film_{begin_film(wanted.path, size_.width, size_.height, wanted.fps)}
        , panes_{wanted_of(options, film_rate_hz), options.beside} {}

    void run() {
        if (wait_until([&] { return all_have_pictures(panes_); }, true)) {
            try {
                if (hold()) {
                    record_all();
                }
            } catch (...) {
                give_back();
                throw;
            }
            give_back();
        }
        film_->finish();
        std::cout << wanted_.path << ": " << film_->picture_count() << " pictures, ticks " << first_tick_ << " to "
                  << last_tick_ << '\n';
        if (missed_ticks_ > 0) {
            std::cerr << "evoview: " << missed_ticks_ << " ticks in between were not shown: "
                      << (leader().may_command() ? "somebody else ran the world meanwhile"
                                                 : "a viewer cannot step the world")
                      << '\n';
        }
    }

  private:
    /// The world that says when it is enough.
    Watch& leader() { return panes_[0].watch; }

    void record_all() {
        const evod::v1::SnapshotFrame& first = leader().picture()->about;
        first_tick_ = last_tick_ = first.tick();
        first_generation_ = first.generation();
        do {
            for (std::size_t i = 0; i < panes_.size(); ++i) {
                if (was_reset(i)) {
                    throw std::runtime_error{quoted(panes_[i].watch.control().world()) +
                                             " was reset while it was recorded"};
                }
            }
            const evod::v1::SnapshotFrame& shown = leader().picture()->about;
            if (wanted_.generations && shown.generation() >= first_generation_ + *wanted_.generations) {
                return;
            }
            if (film_->picture_count() > 0 && shown.tick() == last_tick_) {
                continue; // it ended where it stood
            }
            if (film_->picture_count() > 0 && shown.tick() > last_tick_ + wanted_.every_ticks) {
                missed_ticks_ += shown.tick() - last_tick_ - wanted_.every_ticks;
            }
            last_tick_ = shown.tick();
            film_->add(stage_.capture(
                           panes_, {.width_pixels = size_.width, .height_pixels = size_.height, .now = Clock::now()}),
                       last_tick_);
            if (wanted_.ticks && last_tick_ >= first_tick_ + *wanted_.ticks) {
                return;
            }
        } while (advance());
    }

    /// Stops the worlds that are stepped where they are, so that no tick passes between the first picture and the next.
    bool hold() {
        targets_.assign(panes_.size(), 0);
        for (std::size_t i = 0; i < panes_.size(); ++i) {
            Watch& watch = panes_[i].watch;
            run_ids_.push_back(watch.picture()->about.run_id());
            if (watch.may_command() && !is_over(watch)) {
                step(watch, watch.picture()->about.tick(), i);
            }
        }
        return wait_until([&] { return all_have_pictures(panes_) && all_arrived(); }, true);
    }

    /// Brings every world on to its next picture. False: the leader has no further one, or the recording was ended.
    bool advance() {
        targets_.assign(panes_.size(), 0); // ticks to be waited for
        for (std::size_t i = 0; i < panes_.size(); ++i) {
            Watch& watch = panes_[i].watch;
            const std::uint64_t tick = watch.picture()->about.tick();
            std::uint64_t target = tick + wanted_.every_ticks;
            if (watch.replay() != nullptr && watch.may_command()) {
                target = std::min(target, watch.replay()->last_tick());
            }
            if (is_over(watch) || target <= tick) {
                if (i == 0) {
                    return false;
                }
            } else if (watch.may_command()) {
                step(watch, target, i);
            } else if (i == 0) {
                targets_[i] = target;
            }
        }
        return wait_until([&] { return all_arrived(); }, leader().may_command());
    }

    /// A tick that is over already only stops the world; where, is told by the answer.
    void step(Watch& watch, std::uint64_t tick, std::size_t pane) {
        targets_[pane] = tick;
        evod::v1::Request request;
        request.mutable_run_until_tick()->set_world(watch.control().world());
        request.mutable_run_until_tick()->set_tick(tick);
        watch.ask(std::move(request), [this, &watch, pane](const core::Result<evod::v1::Response>& response) {
            if (!response) {
                refusal_ = response.error().what;
            } else if (!core::accepted(*response) && !is_over(watch)) {
                refusal_ = shown_refusal(response->status());
            } else {
                targets_[pane] = std::max(targets_[pane], response->world().tick());
            }
        });
    }

    bool was_reset(std::size_t pane) {
        const codec::DecodedSnapshot* picture = panes_[pane].watch.picture();
        return picture != nullptr && picture->about.run_id() != run_ids_[pane];
    }

    bool all_arrived() {
        for (std::size_t i = 0; i < panes_.size(); ++i) {
            const std::vector<Tile> tiles = panes_[i].tiles();
            const bool arrived = std::ranges::all_of(tiles, [&](const Tile& tile) {
                const auto& picture = tile.view.latest();
                return picture && picture->about.tick() >= targets_[i];
            });
            if (!arrived && !is_over(panes_[i].watch) && !was_reset(i)) {
                return false;
            }
        }
        return true;
    }

    /// False if the recording was ended meanwhile.
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
                check_hope(panes_[i].watch);
            }
            if (!refusal_.empty()) {
                throw std::runtime_error{refusal_};
            }
            if (interrupted) {
                return false;
            }
            if (limited && Clock::now() >= end) {
                throw std::runtime_error{"no picture came within " + core::duration(wanted_.timeout_s) + ": " +
                                         standing(leader())};
            }
            std::this_thread::sleep_for(look_again);
        }
    }

    /// A world that was only lent goes on at once, and not when its lease is over.
    void give_back() {
        for (std::size_t i = 0; i < panes_.size(); ++i) {
            Watch& watch = panes_[i].watch;
            if (watch.may_command() && watch.replay() == nullptr) {
                evod::v1::Request request;
                request.mutable_release_lease()->set_world(watch.control().world());
                watch.ask(std::move(request), [](const auto&) {}); // without a lease there is nothing to give back
            }
        }
        const auto end = Clock::now() + give_back_max;
        for (std::size_t i = 0; i < panes_.size(); ++i) {
            while (!panes_[i].watch.all_answered() && Clock::now() < end) {
                std::this_thread::sleep_for(look_again);
                panes_[i].watch.update(Clock::now());
            }
        }
    }

    const Options::Record& wanted_;
    double scale_;
    Options::Size size_;
    std::unique_ptr<Film> film_; // first: without a place for its pictures no world is touched
    Stage stage_{scale_};
    Panes panes_;
    std::vector<std::uint64_t> targets_;
    std::vector<std::string> run_ids_; // of each pane's world
    std::string refusal_;
    std::uint64_t first_tick_ = 0, last_tick_ = 0, first_generation_ = 0, missed_ticks_ = 0;
};

} // namespace

void record(const Options& options, const Options::Record& wanted) {
    sf::Context context{context_settings(), 1, 1};
    for (const int signal : {SIGINT, SIGTERM}) {
        std::signal(signal, [](int) { interrupted = 1; });
    }
    Recorder{options, wanted}.run();
}

} // namespace evod::viewer
