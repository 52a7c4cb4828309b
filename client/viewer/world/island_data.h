// IslandData: what the server reports about the chosen island in addition to its snapshots: the genes and forces of its
// population, and the selected organism. It remembers the selection while another generation is shown.
//
// Owner        WorldView.
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/world/population_poll.h"
#include "client/viewer/world/selected_organism.h"
#include "client/viewer/world/viewed_world.h"

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace evod::viewer {

class IslandData {
  public:
    using Clock = core::SnapshotInterpolator::Clock;

    /// What is drawn of the population.
    struct Needs {
        bool genes = false;  // requested once per generation
        bool forces = false; // requested again while the world runs
    };

    /// Reads the newest snapshot, and requests what is needed. Call it once per frame.
    void update(ViewedWorld& world, Needs needs, Clock::time_point now);

    /// Returns the population of the newest snapshot's island and generation; null until it has been received.
    const Population* population() const {
        const Population* complete = population_poll_.complete();
        return complete != nullptr && complete->generation() == generation_ ? complete : nullptr;
    }
    /// Returns why the population is unknown, as a sentence. Empty if it is known or has been requested.
    std::string problem() const { return population_poll_.problem(); }
    /// Returns the organism that was selected last, even after its generation has ended. Null if no organism has been
    /// selected.
    const SelectedOrganism* selected_organism() const { return selected_ ? &*selected_ : nullptr; }

    /// Returns the organism that the camera follows.
    std::optional<std::uint32_t> followed() const { return followed_; }
    /// Starts following the selected organism, or stops following it.
    void toggle_following(const WorldFeed& feed);
    void stop_following() { followed_.reset(); }

  private:
    static constexpr std::chrono::milliseconds poll_interval{250}; // for requests of values that change often

    void forget();
    void take_snapshot(WorldFeed& feed, const std::shared_ptr<const codec::ReceivedSnapshot>& snapshot);
    void keep_selection(ViewedWorld& world);
    void request_population(ViewedWorld& world, Needs needs, Clock::time_point now);
    void request_organism(ViewedWorld& world, Clock::time_point now);

    std::uint64_t place_ = 0; // WorldFeed::place_number()
    std::string run_id_;      // empty until the first snapshot arrives
    std::uint64_t generation_ = 0, tick_ = 0;
    std::shared_ptr<const codec::ReceivedSnapshot> snapshot_; // the newest
    PopulationPoll population_poll_{poll_interval};
    Poll organism_poll_{poll_interval};
    std::uint64_t population_tick_ = 0, organism_tick_ = 0; // tick of the newest snapshot at the time of each request
    std::optional<SelectedOrganism> selected_;
    std::optional<std::uint32_t> followed_;

    /// The selection. It is restored when its generation is on the screen again, for example after a seek.
    struct Kept {
        std::string run_id;
        std::uint32_t island = 0, organism = 0; // every generation uses the same ids
        std::uint64_t generation = 0;
        bool followed = false;
        bool out_of_sight = false; // another generation, island or world is shown
    };
    std::optional<Kept> kept_;
};

} // namespace evod::viewer
