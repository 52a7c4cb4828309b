// IslandView: how a pane shows its chosen island: the view options, the data they need from the server, the organism that
// is selected and followed, and the region that is streamed.
//
// Owner        Pane.
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/island/marks.h"
#include "client/viewer/world/organism_history.h"
#include "client/viewer/world/population_poll.h"
#include "client/viewer/world/viewed_world.h"

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace evod::viewer {

/// What of an island is drawn, and how: the switches of the View panel.
struct ViewOptions {
    ColourBy colour_by = ColourBy::Nothing;
    std::size_t gene = 0; // coloured by, as an index in the world's genes
    palette::Ramp ramp = palette::Ramp::Viridis;
    bool radii = false, forces = false, trails = false;
    bool density = true; // densities replace organisms that are too small to see
    bool minimap = true; // while part of the island is out of sight
};

/// The region and detail in which a large island is streamed. The region is twice as wide and high as the visible part,
/// so that panning does not leave it at once. It changes at most once per `interval`.
class StreamedRegion {
  public:
    using Clock = core::WorldView::Clock;
    static constexpr std::chrono::milliseconds interval{200};

    /// The view to request now; nullopt: the one returned last still serves.
    std::optional<evod::v1::View> update(const Camera& camera, evod::v1::Detail detail, Clock::time_point now);
    void forget() { *this = StreamedRegion{}; }

  private:
    std::optional<Rectangle> region_;
    evod::v1::Detail detail_ = evod::v1::DETAIL_UNSPECIFIED;
    Clock::time_point changed_{};
};

class IslandView {
  public:
    using Clock = core::WorldView::Clock;

    ViewOptions options;
    /// Colours by the next of: nothing, each gene, health, lineage; then by nothing again.
    void next_colouring();

    /// Organisms born per generation from which an island is streamed in part; smaller islands are streamed whole.
    static constexpr std::uint32_t streamed_in_part_min = 5'000;

    /// Takes in the newest snapshot, requests what the options need, and moves the streamed region.
    void update(ViewedWorld& world, const Camera& camera, Clock::time_point now);

    /// Keeps the followed organism in the middle. Ends when a person moves the camera, or the organism dies.
    void follow(ViewedWorld& world, Camera& camera, double blend);
    bool following() const { return followed_.has_value(); }
    /// Follows the selected organism, or stops following.
    void toggle_following(ViewedWorld& world);

    // What is known.
    const std::vector<std::string>& gene_names() const { return gene_names_; }
    /// Of the island and generation of the newest snapshot; null until known.
    const Population* population() const {
        const Population* complete = population_poll_.complete();
        return complete != nullptr && complete->generation() == generation_ ? complete : nullptr;
    }
    /// Why the population is not known, as a sentence; empty if it is known or on its way.
    std::string problem() const { return population_poll_.problem(); }
    const FamilyColours& family_colours() const { return family_colours_; }
    const Trails& trails() const { return trails_; }
    /// Of the organism that was selected last, also after its generation has ended; null: none was.
    const OrganismHistory* organism_history() const { return organism_history_ ? &*organism_history_ : nullptr; }
    /// Whether densities are shown because organisms are too small.
    bool shows_density(const Camera& camera) const {
        return options.density && options.colour_by == ColourBy::Nothing && too_small_to_see(camera);
    }

  private:
    static constexpr std::chrono::milliseconds poll_interval{250}; // for values that change in every tick

    /// What is shown; on a change everything is forgotten.
    struct Shown {
        std::uint64_t number = 0; // WorldFeed::place_number()
        std::string run_id;       // empty before the first snapshot
        friend bool operator==(const Shown&, const Shown&) = default;
    };
    PopulationPoll::Of population_of(const ViewedWorld& world) const;
    bool needs_population() const;
    void forget();
    void take_snapshot(ViewedWorld& world, const std::shared_ptr<const codec::DecodedSnapshot>& snapshot);
    void take_population();
    void request_organism(ViewedWorld& world, Clock::time_point now);
    void update_stream(ViewedWorld& world, const Camera& camera, Clock::time_point now);

    Shown shown_;
    std::uint64_t generation_ = 0, tick_ = 0;                // of the newest snapshot
    std::shared_ptr<const codec::DecodedSnapshot> snapshot_; // the newest snapshot

    std::vector<std::string> gene_names_;
    PopulationPoll population_poll_{poll_interval};
    Poll organism_poll_{poll_interval};
    std::uint64_t taken_count_ = 0;                         // complete populations
    std::uint64_t population_tick_ = 0, organism_tick_ = 0; // of the newest snapshot when they were requested
    FamilyColours family_colours_;
    Trails trails_;
    std::optional<OrganismHistory> organism_history_;

    struct Followed {
        std::uint32_t id = 0;
        std::optional<Point> centre{}; // where follow() put the camera
        double zoom = 0;
    };
    std::optional<Followed> followed_;
    StreamedRegion region_;
    bool in_part_ = false; // streamed in part: the island is large
};

} // namespace evod::viewer
