// ViewedWorld: the world that the window shows. It has four parts: the connection to the server, the data that the
// server reports about the world, the commands to the world, and its replays.
//
// No function blocks. Requests are only sent, and update() processes everything received since the last call.
//
// Owner        WorldView.
// Threads      used by the thread that draws; core::Connection has its own thread.
#pragma once

#include "client/viewer/world/replay_control.h"
#include "client/viewer/world/server_connection.h"
#include "client/viewer/world/world_commands.h"
#include "client/viewer/world/world_feed.h"

#include <cstdint>
#include <optional>
#include <string>

namespace evod::viewer {

class ViewedWorld {
  public:
    explicit ViewedWorld(const WantedWorld& wanted);

    ServerConnection server;
    WorldFeed feed;
    ReplayControl replay;
    WorldCommands commands;

    /// Processes the answers, events and snapshots that have arrived. Returns whether there is a new snapshot.
    bool update(WorldFeed::Clock::time_point now);

    void show(std::string world, std::uint32_t island);
    /// Shows the world after this one in the server's list.
    void show_next_world();
    /// Opens a replay of the world at the tick shown, or returns from it to the live world.
    void toggle_replay();
    /// Shows the first tick of a generation of the run, in a replay.
    void show_generation(std::uint64_t generation);

    /// A link that shows this moment in a browser. Empty if the server has no page that this machine can reach, or if
    /// no snapshot has arrived.
    std::string link() const;
    /// A link that shows the live world in a browser, as it runs. Empty if the server has no page that this machine can
    /// reach.
    std::string live_link() const;

    /// Whether every request has been answered. False until the first connection is established.
    bool all_answered() const { return server.all_answered() && !replay.opening(); }
    /// Why the server sends no snapshots, as a sentence; nullopt if it sends them or has not answered yet.
    std::optional<std::string> refusal() const;
    /// The state of the world as text: "running", "waiting – Space runs", "at the end of the replay", "no connection".
    std::string state_text() const;

  private:
    std::string page() const;
    void take_event(const evod::v1::Event& event);
    std::optional<std::string> world_after_this(const evod::v1::WorldList& worlds) const;

    bool next_world_wanted_ = false; // show the next world as soon as connected
};

} // namespace evod::viewer
