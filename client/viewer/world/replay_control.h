// ReplayControl: opens a replay of the viewed world, seeks in it, forks worlds from it, and returns to the live world.
//
// The server provides a replay as a separate world beside the live one. The replay belongs to this session:
// ReplayControl opens and closes it, and the session may command it in any role.
//
// It has more than 30 members, because opening, seeking, forking and returning change the same state.
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
#include <utility>

namespace evod::viewer {

/// The message for a session with the role viewer when it tries to command a world.
constexpr std::string_view read_only_text = "You are connected as a viewer: read-only";

class ReplayControl {
  public:
    /// If `wanted` names a generation, opens a replay at this generation.
    ReplayControl(ServerConnection& server, WorldFeed& feed, const WantedWorld& wanted);
    ReplayControl(const ReplayControl&) = delete;
    ReplayControl& operator=(const ReplayControl&) = delete;

    /// Opens a replay of the viewed world at the moment `at`. The replay is shown as soon as the server has opened it.
    void open(evod::v1::RunMoment at);
    void return_to_present();
    /// Seeks to another moment of the replay. If several seeks are requested while one is running, only the newest of
    /// them is kept.
    void seek(evod::v1::RunMoment to);
    /// Seeks to the first tick of the generation that is `by` after the shown one, or after the target generation of a
    /// running seek.
    void seek_generations(int by);
    /// Returns the tick range of the viewed replay, whether it was opened here or is served from a run file; null for a
    /// live world.
    const evod::v1::Replay* info() const { return feed_.replay(); }
    /// Returns whether ReplayControl opened the replay, so that return_to_present() closes it.
    bool is_own() const { return present_.has_value(); }
    /// Returns whether a run file's replay shows its last tick, so that it can only go back. Always false for a replay
    /// of a live world, whose range grows.
    bool at_end() const;
    /// Returns the live world that return_to_present() will show; nullopt if no replay was opened here.
    const std::optional<std::string>& present() const { return present_; }
    /// Returns the target of the newest seek; null if no seek is running.
    const evod::v1::RunMoment* target() const { return seeks_.target(); }

    /// Creates a world that starts from the moment shown. Its name is that of the live world with a number.
    void fork();
    /// Returns the name of the fork that the server has created, once; empty if there is no new one.
    std::string take_new_fork() { return std::exchange(new_fork_, {}); }

    // ViewedWorld calls the following functions.

    /// Returns whether an OpenReplay request is unanswered.
    bool opening() const { return opening_.valid(); }
    /// Returns why the replay requested at the start of evoview cannot be shown, as a sentence; nullopt: no such
    /// problem.
    const std::optional<std::string>& open_refusal() const { return open_refusal_; }
    /// Clears all data about the viewed world and closes its replay. Call before another world is shown.
    void leave();
    /// Shows the replay once the server has opened it. Requests its tick range once a second, because it grows with the
    /// live world.
    void update(WorldFeed::Clock::time_point now);

  private:
    void show(std::string world);
    void send_fork(const std::string& name);
    void send_seek(std::optional<evod::v1::RunMoment> to);
    void take_opened();
    void close(const std::string& world);

    ServerConnection& server_;
    WorldFeed& feed_;
    SeekQueue seeks_;
    std::optional<std::string> present_;  // the live world, while its replay is shown
    core::SubscriptionHandle own_events_; // events of the replay, which a subscription to all worlds does not include
    std::future<core::Result<evod::v1::Response>> opening_; // the pending answer to OpenReplay
    std::string opening_of_;                                // the world that was viewed when OpenReplay was sent
    bool opening_at_start_;                                 // the pending replay was requested at the start of evoview
    std::optional<std::string> open_refusal_;
    WorldFeed::Clock::time_point range_requested_{};
    std::string new_fork_;
};

} // namespace evod::viewer
