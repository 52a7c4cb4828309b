// WorldFeed: the data that the server reports about the viewed world: snapshots of one island or all islands, the state
// of the run, statistics and events.
//
// WorldFeed has one subscription to snapshots. While a view is set, it has a second one for the minimap, which receives
// a density of the whole island once a second.
//
// It has more than 30 members, because every panel and strip reads what the server reports in this one place.
//
// Owner        ViewedWorld.
// Threads      used by the thread that draws.
#pragma once

#include "client/core/snapshot_interpolator.h"
#include "client/viewer/world/gene_groups.h"
#include "client/viewer/world/healthiest.h"
#include "client/viewer/world/run_control.h"
#include "client/viewer/world/server_connection.h"

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace evod::viewer {

/// Specifies the world to view and its server.
struct WantedWorld {
    core::Options connection; // server and credentials
    std::string world;        // empty: the server's choice
    std::uint32_t island = 0;
    double rate_hz = 30;                                 // snapshots per second
    bool all_islands = false;                            // false: only `island`
    std::optional<std::uint64_t> replay_generation = {}; // start with a replay of the world at this generation
};

class WorldFeed {
  public:
    using Clock = core::SnapshotInterpolator::Clock;

    WorldFeed(ServerConnection& server, const WantedWorld& wanted);
    WorldFeed(const WorldFeed&) = delete;
    WorldFeed& operator=(const WorldFeed&) = delete;

    // The following functions select the data to show.

    /// Subscribes to another world or island. If the world is another one, clears all data about the old one.
    void show(std::string world, std::uint32_t island);
    void choose_island(std::uint32_t island);
    /// Chooses the island whose number is greater by `by`. The first island follows the last.
    void cycle_island(int by);
    /// Sets whether to receive snapshots of all islands or only of the chosen one.
    void show_all_islands(bool all);
    bool all_islands() const { return all_islands_; }
    /// Sets the region and the level of detail to receive. Nullopt: whole snapshots; this is the initial state, also
    /// after each show().
    void set_view(std::optional<evod::v1::View> view);

    /// Returns the requested world name. If none was requested: empty until the server's choice is known.
    const std::string& world() const { return world_; }
    /// Returns the world's name as reported by the server; until then, the same as world().
    const std::string& name() const { return control_.known() ? control_.world() : world_; }
    /// Returns the chosen island.
    std::uint32_t island() const { return island_; }
    /// Returns a number that changes whenever another world, replay or island is shown. No two feeds ever have the same
    /// number.
    /// An answer to a request that was sent under another number is outdated.
    std::uint64_t place_number() const { return place_number_; }

    /// Selects an organism, which panels describe and the camera may follow. `organism` is an id of the current
    /// generation.
    void select(std::optional<std::uint32_t> organism) { selected_ = organism; }
    std::optional<std::uint32_t> selected() const { return selected_; }

    // The following functions return data reported by the server.

    core::SnapshotInterpolator& view() { return views_[island_]; }
    core::SnapshotInterpolator& view_of(std::uint32_t island) { return views_[island]; }
    /// Returns the newest snapshot of the chosen island; null until one has arrived.
    const codec::ReceivedSnapshot* snapshot() const { return snapshot_of(island_); }
    const codec::ReceivedSnapshot* snapshot_of(std::uint32_t island) const;
    /// Returns the indices of the healthiest organisms in the newest snapshot of an island, as HealthRanking::of().
    std::span<const std::size_t> healthiest(std::uint32_t island, std::size_t count) {
        return rankings_[island].of(views_[island].latest(), count);
    }
    /// Returns the number of islands of the world; 1 until a snapshot has arrived.
    std::uint32_t island_count() const;
    /// Returns densities of the whole island, updated about once a second while a view is set; otherwise null.
    const std::shared_ptr<const codec::ReceivedSnapshot>& overview() const { return overview_snapshot_; }
    const RunControl& control() const { return control_; }
    RunControl& control() { return control_; }
    /// Returns the tick range, if the world is a replay; null for a live world.
    const evod::v1::Replay* replay() const { return replay_ ? &*replay_ : nullptr; }
    /// Returns the names of the genes of the viewed run, in the order in which all gene lists are sent. Empty until the
    /// server has reported them.
    const std::vector<std::string>& gene_names() const { return gene_names_; }
    /// Returns the group of each gene, in the same order.
    const GeneGroups& gene_groups() const { return gene_groups_; }
    /// Returns statistics of the last finished generation on the chosen island; null in the first generation.
    const evod::v1::GenerationStatistics* last_generation() const;
    /// Returns the state of the server's run files; unspecified if the server stores none or the world is a replay.
    const evod::v1::Storage& storage() const { return storage_; }
    /// Returns the events that the last update received, of all worlds, oldest first.
    const std::vector<evod::v1::Event>& events() const { return events_; }
    /// Returns why the server refused the subscription to snapshots, as a sentence; nullopt if it was accepted or has
    /// not been answered.
    std::optional<std::string> refusal() const;

    // The other parts of ViewedWorld call the following functions.

    void take_storage(evod::v1::Storage storage) { storage_ = std::move(storage); }
    /// Stores the state of the world that an answer or event contains.
    void take_info(const evod::v1::WorldInfo& world);
    /// Fetches the received events from the connection. events() returns them until the next call.
    void take_events();
    /// Updates the stored data according to one event.
    void apply(const evod::v1::Event& event);
    /// Fetches the received snapshots. Returns whether there is a new one.
    bool take_snapshots(Clock::time_point now);
    void request_statistics() { request_statistics(world_); }
    void request_statistics(const std::string& world);

  private:
    void subscribe();
    void subscribe_overview();
    void begin_place();
    void forget_genes();

    ServerConnection& server_;
    std::string world_;
    bool servers_choice_; // no world was requested
    std::uint32_t island_;
    double rate_hz_;
    bool all_islands_;
    std::uint64_t place_number_;
    std::optional<std::uint32_t> selected_;

    core::SubscriptionHandle snapshot_subscription_, event_subscription_;
    std::optional<core::SubscriptionHandle> overview_subscription_;
    std::optional<evod::v1::View> streamed_view_;
    std::map<std::uint32_t, core::SnapshotInterpolator> views_; // one view per island number
    std::map<std::uint32_t, HealthRanking> rankings_;           // of the latest snapshot in each view
    std::shared_ptr<const codec::ReceivedSnapshot> overview_snapshot_;
    RunControl control_;
    std::optional<evod::v1::Replay> replay_;
    std::vector<std::string> gene_names_;
    GeneGroups gene_groups_;
    std::vector<evod::v1::GenerationStatistics> last_generation_; // one per island
    evod::v1::Storage storage_;
    std::vector<evod::v1::Event> events_;
};

} // namespace evod::viewer
