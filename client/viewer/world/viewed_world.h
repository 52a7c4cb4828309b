// ViewedWorld: the world that a pane shows, in four parts: the connection to its server, what the server reports of it,
// the commands to it, and its replays.
//
// Nothing here blocks: requests are sent, and update() takes in what has arrived since the last call.
//
// Owner        a pane.
// Threads      used by the thread that draws; core::Connection has its own.
#pragma once

#include "client/viewer/world/replay_control.h"
#include "client/viewer/world/server_connection.h"
#include "client/viewer/world/world_commands.h"
#include "client/viewer/world/world_feed.h"

#include <cstdint>
#include <functional>
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

    /// Takes in answers, events and snapshots. Returns whether there is a new snapshot.
    bool update(WorldFeed::Clock::time_point now);

    void show(std::string world, std::uint32_t island);
    /// Shows the world that comes after this one in the server's list.
    void show_next_world();
    /// Asks the server which world comes after this one. An update() calls the handler with its name; if there is none,
    /// a notice says what to do instead.
    void find_next_world(std::function<void(const std::string& world)> found);

    /// Whether no request is unanswered. False until the first connection.
    bool all_answered() const { return server.all_answered() && !replay.opening(); }
    /// Why the server sends no snapshots, as a sentence; nullopt: it sends them, or has not answered yet.
    std::optional<std::string> refusal() const;
    /// "running", "waiting – Space runs", "at the end of the replay", "no connection".
    std::string state_text() const;

  private:
    void take_event(const evod::v1::Event& event);
    std::optional<std::string> world_after_this(const evod::v1::WorldList& worlds);

    bool next_world_wanted_ = false; // once connected
};

} // namespace evod::viewer
