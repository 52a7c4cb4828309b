// Sight: what of an island is shown, and how: the switches of the View panel, what has to be asked for them, the
// organism that is selected and followed, and the region that is streamed.
//
// Owner        the pane.
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/scene/marks.h"
#include "client/viewer/watch/organism_story.h"
#include "client/viewer/watch/population_inquiry.h"
#include "client/viewer/watch/watch.h"

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace evod::viewer {

/// The region and the detail in which a large island is streamed. A little more is asked for than is seen, so that a
/// hand that moves the picture does not outrun it, and not more often than every `between`.
class StreamedRegion {
  public:
    using Clock = core::WorldView::Clock;
    static constexpr std::chrono::milliseconds between{200};

    /// The view to ask for now; nullopt: the one that was returned last will do.
    std::optional<evod::v1::View> update(const Camera& camera, evod::v1::Detail detail, Clock::time_point now);
    void forget() { *this = StreamedRegion{}; }

  private:
    std::optional<Rectangle> streamed_;
    evod::v1::Detail detail_ = evod::v1::DETAIL_UNSPECIFIED;
    Clock::time_point asked_{};
};

class Sight {
  public:
    using Clock = core::WorldView::Clock;

    // The switches.
    struct Shown {
        ColourBy colour_by = ColourBy::Nothing;
        std::size_t gene = 0;
        palette::Ramp ramp = palette::Ramp::Viridis;
        bool radii = false, forces = false, trails = false;
        bool density = true; // in place of organisms that are too small to be seen
        bool minimap = true; // where not all of the island is seen
    };
    Shown shown;
    /// Nothing, each gene, health, lineage, and from the beginning.
    void next_colouring();

    /// Islands on which so many are born are streamed in part; smaller ones always whole.
    static constexpr std::uint32_t streamed_in_part_min = 5'000;

    /// Takes in the picture that is shown, asks for what the switches need, and moves the region that is streamed.
    void update(Watch& watch, const Camera& camera, Clock::time_point now);

    /// Keeps the selected organism in the middle; a hand that moves the picture, or its end, lets go of it.
    void follow(Watch& watch, Camera& camera, double blend);
    bool following() const { return followed_.has_value(); }
    /// Follows who is selected, or nobody any more.
    void toggle_following(Watch& watch);

    // What is known.
    const std::vector<std::string>& gene_names() const { return gene_names_; }
    /// Of the generation and island that the picture shows; null while it is not known.
    const Population* population() const {
        const Population* whole = population_.whole();
        return whole != nullptr && whole->generation() == generation_ ? whole : nullptr;
    }
    /// Why it is not known; empty if it is, or comes.
    std::string trouble() const { return population_.trouble(); }
    const FamilyColours& family_colours() const { return family_colours_; }
    const Trails& trails() const { return trails_; }
    /// Of the organism that was selected last, also when its generation is over; null: none was.
    const OrganismStory* story() const { return story_ ? &*story_ : nullptr; }
    /// Whether organisms are shown as densities, as they are too small.
    bool shows_density(const Camera& camera) const {
        return shown.density && shown.colour_by == ColourBy::Nothing && too_small_to_see(camera);
    }

  private:
    static constexpr std::chrono::milliseconds poll{250}; // of what changes all the time

    /// What is looked at; with another one everything is forgotten.
    struct Place {
        std::uint64_t number = 0; // of the watch
        std::string run_id;       // empty before the first picture
        friend bool operator==(const Place&, const Place&) = default;
    };
    PopulationInquiry::Of population_of(const Watch& watch) const;
    bool needs_population() const;
    void forget();
    void see(Watch& watch, const std::shared_ptr<const codec::DecodedSnapshot>& picture);
    void take_population();
    void ask_organism(Watch& watch, Clock::time_point now);
    void stream(Watch& watch, const Camera& camera, Clock::time_point now);

    Place place_;
    std::uint64_t generation_ = 0, tick_ = 0;            // of the picture
    std::shared_ptr<const codec::DecodedSnapshot> seen_; // the last picture that was taken in

    std::vector<std::string> gene_names_;
    PopulationInquiry population_{poll};
    Inquiry organism_{poll};
    std::uint64_t taken_count_ = 0;                         // of whole populations
    std::uint64_t population_tick_ = 0, organism_tick_ = 0; // of the picture that was shown as they were asked for
    FamilyColours family_colours_;
    Trails trails_;
    std::optional<OrganismStory> story_;

    struct Followed {
        std::uint32_t id = 0;
        std::optional<Point> centre{}; // where the camera was put
        double zoom = 0;
    };
    std::optional<Followed> followed_;
    StreamedRegion region_;
    bool in_part_ = false; // the island is large
};

} // namespace evod::viewer
