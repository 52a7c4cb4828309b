// IslandView: how the chosen island is shown: the view options, the data that these options need from the server,
// the selected and followed organism, and the region that is streamed.
//
// Owner        WorldView.
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/island/flashes.h"
#include "client/viewer/island/marks.h"
#include "client/viewer/world/population_poll.h"
#include "client/viewer/world/selected_organism.h"
#include "client/viewer/world/viewed_world.h"

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace evod::viewer {

/// The organisms of which radii or forces are drawn. Pointed: the one at the mouse and the selected one.
enum class Which : std::uint8_t { None, Pointed, All };
constexpr std::array<std::string_view, 3> which_names{"none", "at the mouse or selected", "all"};
inline Which next(Which which) {
    return static_cast<Which>((static_cast<std::size_t>(which) + 1) % which_names.size());
}

/// The settings of the View panel: which parts of an island are drawn, and how.
struct ViewOptions {
    Look look;
    ColourBy colour_by = ColourBy::Nothing;
    std::size_t gene = 0; // index of the gene that colours organisms, in the world's list of genes
    palette::Ramp ramp = palette::Ramp::Violet;
    bool trails = true, flashes = true;
    Which radii = Which::Pointed, forces = Which::None;
    bool density = true; // draw densities in place of organisms that are too many to see
    bool minimap = true; // show the minimap while part of the island is out of sight
    friend bool operator==(const ViewOptions&, const ViewOptions&) = default;
};

/// The options with which a look is shown at first. The classic skin shows organisms, items and walls only.
ViewOptions default_options(Look look);

/// Chooses the region and the level of detail in which a large island is streamed. The region is twice as wide and high
/// as the visible part, so that a small pan stays inside it. The region changes at most once per `interval`.
class StreamedRegion {
  public:
    using Clock = core::SnapshotInterpolator::Clock;
    static constexpr std::chrono::milliseconds interval{200};

    /// Returns the view to request now; nullopt if the view returned last is still suitable.
    std::optional<evod::v1::View> update(const Camera& camera, evod::v1::Detail detail, Clock::time_point now);
    void forget() { *this = StreamedRegion{}; }

  private:
    std::optional<Rectangle> region_;
    evod::v1::Detail detail_ = evod::v1::DETAIL_UNSPECIFIED;
    Clock::time_point changed_{};
};

class IslandView {
  public:
    using Clock = core::SnapshotInterpolator::Clock;

    ViewOptions options;
    /// Switches to the next colouring in this cycle: nothing, each gene, health.
    void next_colouring();

    /// Islands with at least this many organisms per generation are streamed in part. Smaller islands are streamed
    /// whole.
    static constexpr std::uint32_t streamed_in_part_min = 5'000;

    /// Reads the newest snapshot, requests the data that the options need, and moves the streamed region.
    ///
    /// points_at  whether the mouse points at an organism
    void update(ViewedWorld& world, const Camera& camera, Clock::time_point now, bool points_at = false);

    /// Keeps the followed organism in the centre. Following ends when the user moves the camera or the organism dies.
    void follow(ViewedWorld& world, Camera& camera, double blend);
    bool following() const { return followed_.has_value(); }
    /// Starts following the selected organism, or stops following it.
    void toggle_following(ViewedWorld& world);

    // Functions that return data received from the server or derived from it.
    const std::vector<std::string>& gene_names() const { return gene_names_; }
    const GeneGroups& gene_groups() const { return gene_groups_; }
    /// Returns the population of the newest snapshot's island and generation; null until it has been received.
    const Population* population() const {
        const Population* complete = population_poll_.complete();
        return complete != nullptr && complete->generation() == generation_ ? complete : nullptr;
    }
    /// Returns why the population is unknown, as a sentence. Empty if it is known or has been requested.
    std::string problem() const { return population_poll_.problem(); }
    const Trails& trails() const { return trails_; }
    const Flashes& flashes() const { return flashes_; }
    /// Returns the organism that was selected last, even after its generation has ended. Null if no organism has been
    /// selected.
    const SelectedOrganism* selected_organism() const { return selected_organism_ ? &*selected_organism_ : nullptr; }
    /// Returns whether densities are shown because the visible organisms are too small and too many.
    bool shows_density(const Camera& camera, const codec::ReceivedSnapshot& snapshot) const;

  private:
    static constexpr std::chrono::milliseconds poll_interval{250}; // for requests of values that change often

    /// The place (world and island) and the run that are shown. When one changes, all older data are cleared.
    struct Shown {
        std::uint64_t number = 0; // WorldFeed::place_number()
        std::string run_id;       // empty until the first snapshot arrives
        friend bool operator==(const Shown&, const Shown&) = default;
    };
    PopulationPoll::Of population_of(const ViewedWorld& world) const;
    std::size_t cycled_genes() const;
    bool needs_population(bool points_at) const;
    void forget();
    void take_snapshot(ViewedWorld& world, const std::shared_ptr<const codec::ReceivedSnapshot>& snapshot,
                       const Camera& camera);
    void take_population();
    void request_organism(ViewedWorld& world, Clock::time_point now);
    void keep_selection(ViewedWorld& world);
    void update_stream(ViewedWorld& world, const Camera& camera, Clock::time_point now);

    Shown shown_;
    std::uint64_t generation_ = 0, tick_ = 0;                 // generation and tick of the newest snapshot
    std::shared_ptr<const codec::ReceivedSnapshot> snapshot_; // the newest snapshot

    std::vector<std::string> gene_names_;
    GeneGroups gene_groups_;
    PopulationPoll population_poll_{poll_interval};
    Poll organism_poll_{poll_interval};
    std::uint64_t population_tick_ = 0, organism_tick_ = 0; // tick of the newest snapshot at the time of each request
    Trails trails_;
    Flashes flashes_;
    std::optional<SelectedOrganism> selected_organism_;

    struct Followed {
        std::uint32_t id = 0;
        std::optional<Point> centre{}; // centre of the camera set by the last follow()
        double zoom = 0;
    };
    std::optional<Followed> followed_;

    /// The selection. It is restored when its generation is on the screen again, for example after a seek.
    struct Kept {
        std::string run_id;
        std::uint32_t island = 0, organism = 0; // every generation uses the same ids
        std::uint64_t generation = 0;
        bool followed = false;
        bool out_of_sight = false; // another generation, island or world is shown
    };
    std::optional<Kept> kept_;
    StreamedRegion region_;
    bool in_part_ = false; // whether the island is large and therefore streamed in part
};

} // namespace evod::viewer
