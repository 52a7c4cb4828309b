// IslandView: how an island is shown: the view options, the trails and flashes of its snapshots, and the camera that
// follows an organism.
//
// Owner        WorldView.
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/island/flashes.h"
#include "client/viewer/island/marks.h"
#include "client/viewer/world/island_data.h"

#include <array>
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

class IslandView {
  public:
    /// An island of which only the snapshots are known.
    IslandView() = default;
    /// The chosen island. `feed` and `data` must outlive this object.
    IslandView(const WorldFeed& feed, const IslandData& data) : feed_{&feed}, data_{&data} {}

    ViewOptions options;
    /// Switches to the next colouring in this cycle: nothing, each gene of the body, health.
    void next_colouring();

    /// Adds the newest snapshot to the trails and the flashes, unless it was added before.
    void add(const Camera& camera, const std::shared_ptr<const codec::ReceivedSnapshot>& snapshot);
    /// Keeps the followed organism in the centre, as far as the camera stays on the island. Following ends when the
    /// user moves the camera or selects another organism. If the organism is gone, shows the whole island.
    ///
    /// island  the snapshots of the chosen island
    void follow(IslandData& data, const core::SnapshotInterpolator& island, Camera& camera, double blend);

    /// Returns what the options need of the population.
    ///
    /// points_at  whether the mouse points at an organism
    IslandData::Needs needs(bool points_at) const;
    /// Returns whether densities are shown because the visible organisms are too small and too many.
    bool shows_density(const Camera& camera, const codec::ReceivedSnapshot& snapshot) const;
    /// Returns the level of detail in which a large island is streamed.
    evod::v1::Detail detail(const Camera& camera, const codec::ReceivedSnapshot& snapshot) const;

    const std::vector<std::string>& gene_names() const;
    /// Returns the population that is shown; null until it has been received.
    const Population* population() const { return data_ != nullptr ? data_->population() : nullptr; }
    /// Returns why the population is unknown, as a sentence. Empty if it is known or has been requested.
    std::string problem() const { return data_ != nullptr ? data_->problem() : ""; }
    const Trails& trails() const { return trails_; }
    const Flashes& flashes() const { return flashes_; }

  private:
    std::size_t cycled_genes() const;

    const WorldFeed* feed_ = nullptr;
    const IslandData* data_ = nullptr;
    std::shared_ptr<const codec::ReceivedSnapshot> added_;
    Trails trails_;
    Flashes flashes_;
    /// The camera after the last follow().
    struct Followed {
        std::uint32_t organism = 0;
        Point centre;
        double zoom = 0;
    };
    std::optional<Followed> followed_;
};

} // namespace evod::viewer
