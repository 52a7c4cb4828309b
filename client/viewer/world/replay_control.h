// ReplayControl: opens a replay of the viewed world, seeks in it, forks worlds from it, and returns to the live world.
//
// The server shows a replay as a world of its own beside the live one. It belongs to this session: ReplayControl opens
// and closes it, and any role may command it.
//
// Owner        ViewedWorld.
// Threads      used by the thread that draws.
#pragma once

#include "client/viewer/world/seek_queue.h"
#include "client/viewer/world/world_feed.h"

#include <cstdint>
#include <future>
#include <optional>
#include <string>
#include <string_view>

namespace evod::viewer {

/// Why a session with the role viewer may not command a world.
constexpr std::string_view read_only_text = "You are connected as a viewer: read-only";

class ReplayControl {
  public:
    /// Opens the replay that `wanted` names, if it names one.
    ReplayControl(ServerConnection& server, WorldFeed& feed, const WantedWorld& wanted);
    ReplayControl(const ReplayControl&) = delete;
    ReplayControl& operator=(const ReplayControl&) = delete;

    /// Shows a replay of the world as soon as the server has opened it, beginning at a moment.
    void open(evod::v1::RunMoment at);
    void return_to_present();
    /// Seeks another moment of the replay. During a seek only the newest of several further ones is kept.
    void seek(evod::v1::RunMoment to);
    /// Seeks the first tick of the generation that is `by` after the shown one; during a seek, `by` after its target.
    void seek_generations(int by);

    /// The range of the viewed replay, opened here or of a run file; null for a live world.
    const evod::v1::Replay* info() const { return feed_.replay(); }
    /// Whether the replay was opened here, so that return_to_present() leaves it.
    bool is_own() const { return present_.has_value(); }
    /// Whether a run file's replay shows its last tick and can only go back. A replay of a live world grows with it.
    bool at_end() const;
    /// The live world that return_to_present() shows; nullopt: no replay was opened here.
    const std::optional<std::string>& present() const { return present_; }
    /// Where the newest seek goes to; null if none is under way.
    const evod::v1::RunMoment* target() const { return seeks_.target(); }

    /// Makes a new world from the moment that is shown.
    void fork(const std::string& name);
    /// The newest fork of the viewed world, its replay or its live world; empty: none, or deleted since.
    const std::string& forked() const { return forked_; }

    // Called by ViewedWorld.

    /// Whether the server has not answered open() yet.
    bool opening() const { return opening_.valid(); }
    /// Why the replay that the program was started with cannot be shown, as a sentence.
    const std::optional<std::string>& open_refusal() const { return open_refusal_; }
    /// Forgets what belongs to the viewed world, and closes its replay; another world will be shown.
    void leave(const std::string& next_world);
    /// Shows the replay once the server has opened it. Requests its range once a second: it grows with the live world.
    void update(WorldFeed::Clock::time_point now);
    void apply(const evod::v1::Event& event);

  private:
    void show(std::string world);
    void send_seek(std::optional<evod::v1::RunMoment> to);
    void take_opened();
    void close(const std::string& world);

    ServerConnection& server_;
    WorldFeed& feed_;
    SeekQueue seeks_;
    std::optional<std::string> present_;  // set while a replay that was opened here is shown
    core::SubscriptionHandle own_events_; // of that replay; a subscription to all worlds excludes them
    std::future<core::Result<evod::v1::Response>> opening_; // answers an OpenReplay
    std::string opening_of_;                                // the world that was shown when it was sent
    bool opening_at_start_;                                 // the program was started with this replay
    std::optional<std::string> open_refusal_;
    WorldFeed::Clock::time_point range_requested_{};
    std::string forked_;
};

} // namespace evod::viewer
