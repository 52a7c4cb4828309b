// WorldFeed: what the server reports of the viewed world: snapshots of one island or of all, the state of the run,
// statistics and events.
//
// The feed keeps one subscription to snapshots. While a view is set it keeps a second one, which brings a density of
// the whole island once a second for the minimap.
//
// Owner        ViewedWorld.
// Threads      used by the thread that draws.
#pragma once

#include "client/core/world_view.h"
#include "client/viewer/world/run_control.h"
#include "client/viewer/world/server_connection.h"

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace evod::viewer {

/// Which world to view, on which server.
struct WantedWorld {
    core::Options connection; // server and credentials
    std::string world;        // empty: the server's choice
    std::uint32_t island = 0;
    double rate_hz = 30;                                 // of snapshots
    bool all_islands = false;                            // or only `island`
    std::optional<std::uint64_t> replay_generation = {}; // begin with a replay of the world at this generation
};

class WorldFeed {
  public:
    using Clock = core::WorldView::Clock;

    WorldFeed(ServerConnection& server, const WantedWorld& wanted);
    WorldFeed(const WorldFeed&) = delete;
    WorldFeed& operator=(const WorldFeed&) = delete;

    // What is shown.

    /// Subscribes to another world or island. Drops everything known of the world if it is another one.
    void show(std::string world, std::uint32_t island);
    void choose_island(std::uint32_t island);
    /// Chooses the island `by` further on; after the last comes the first.
    void cycle_island(int by);
    /// Receives snapshots of every island, not only of the chosen one.
    void show_all_islands(bool all);
    bool all_islands() const { return all_islands_; }
    /// The region and detail to receive. Nullopt, as at first and after each show(): whole snapshots.
    void set_view(std::optional<evod::v1::View> view);

    /// The requested name; empty: the server's choice.
    const std::string& world() const { return world_; }
    /// The world's name as soon as the server has reported it; before that the same as world().
    const std::string& name() const { return control_.known() ? control_.world() : world_; }
    /// The chosen island.
    std::uint32_t island() const { return island_; }
    /// Changes whenever another world, replay or island is shown; no two feeds have the same number. An answer that was
    /// requested under another number is out of date.
    std::uint64_t place_number() const { return place_number_; }

    /// The organism that panels describe and the camera may follow: an id of the current generation.
    void select(std::optional<std::uint32_t> organism) { selected_ = organism; }
    std::optional<std::uint32_t> selected() const { return selected_; }

    // What the server has reported.

    core::WorldView& view() { return views_[island_]; }
    core::WorldView& view_of(std::uint32_t island) { return views_[island]; }
    /// The newest of the chosen island; null before the first.
    const codec::DecodedSnapshot* snapshot() const { return snapshot_of(island_); }
    const codec::DecodedSnapshot* snapshot_of(std::uint32_t island) const;
    /// 1 before the first snapshot.
    std::uint32_t island_count() const;
    /// Densities of the whole island, about once a second while a view is set; else null.
    const std::shared_ptr<const codec::DecodedSnapshot>& overview() const { return overview_snapshot_; }
    const RunControl& control() const { return control_; }
    RunControl& control() { return control_; }
    /// The range of the replay, if the world is one; null for a live world.
    const evod::v1::Replay* replay() const { return replay_ ? &*replay_ : nullptr; }
    /// Of the run that is shown, in the order of genes everywhere; empty until the server has reported them.
    const std::vector<std::string>& gene_names() const { return gene_names_; }
    /// Of the generation before the current one, on the chosen island; null in the first generation.
    const evod::v1::GenerationStatistics* last_generation() const;
    /// The state of the server's run files; unspecified if it keeps none, or the world is a replay.
    const evod::v1::Storage& storage() const { return storage_; }
    /// Events of all worlds that the last update took in, oldest first.
    const std::vector<evod::v1::Event>& events() const { return events_; }
    /// The server's refusal of the subscription to snapshots, as a sentence; nullopt: accepted, or not answered yet.
    std::optional<std::string> refusal() const;

    // Called by the other parts of ViewedWorld.

    void take_storage(evod::v1::Storage storage) { storage_ = std::move(storage); }
    /// The world's state as an answer or event reports it.
    void take_info(const evod::v1::WorldInfo& world);
    /// Takes the events that have arrived from the connection; they are events() until the next call.
    void take_events();
    /// Updates what is known by one event.
    void apply(const evod::v1::Event& event);
    /// Takes the snapshots that have arrived. Returns whether there is a new one.
    bool take_snapshots(Clock::time_point now);
    void request_statistics() { request_statistics(world_); }
    void request_statistics(const std::string& world);

  private:
    void subscribe();
    void subscribe_overview();
    void begin_place();

    ServerConnection& server_;
    std::string world_;
    std::uint32_t island_;
    double rate_hz_;
    bool all_islands_;
    std::uint64_t place_number_;
    std::optional<std::uint32_t> selected_;

    core::SubscriptionHandle snapshot_subscription_, event_subscription_;
    std::optional<core::SubscriptionHandle> overview_subscription_;
    std::optional<evod::v1::View> streamed_view_;
    std::map<std::uint32_t, core::WorldView> views_; // by island
    std::shared_ptr<const codec::DecodedSnapshot> overview_snapshot_;
    RunControl control_;
    std::optional<evod::v1::Replay> replay_;
    std::vector<std::string> gene_names_;
    std::vector<evod::v1::GenerationStatistics> last_generation_; // one per island
    evod::v1::Storage storage_;
    std::vector<evod::v1::Event> events_;
};

} // namespace evod::viewer
