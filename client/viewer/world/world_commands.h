// WorldCommands: sends the user's commands to the viewed world.
//
// If the session's role forbids a command, the command is not sent, and a notice explains why. The effect of a sent
// command is assumed until its answer arrives (run_control.h).
//
// Owner        ViewedWorld.
// Threads      used by the thread that draws.
#pragma once

#include "client/viewer/world/replay_control.h"

#include <cstdint>
#include <optional>
#include <string_view>

namespace evod::viewer {

class WorldCommands {
  public:
    WorldCommands(ServerConnection& server, WorldFeed& feed, const ReplayControl& replay)
        : server_{server}, feed_{feed}, replay_{replay} {}

    void pause_or_resume();
    void step(std::uint64_t ticks);
    void run_generations(std::uint64_t generations);
    void faster();
    void slower();
    void real_time();
    void max_speed();
    void at_factor(double factor);
    void reset(std::optional<std::uint64_t> seed);

    /// Returns whether this session may command the viewed world. A session with the role viewer may command the replay
    /// that it opened itself.
    bool may_command() const { return !server_.read_only() || replay_.is_own(); }
    /// Returns why this session may not command the world, as a sentence without a full stop. Empty if it may.
    std::string_view read_only_reason() const { return may_command() ? "" : read_only_text; }

  private:
    template <class MakeRequest>
    void command(MakeRequest make_request);
    bool is_over();
    void send(std::optional<evod::v1::Request> request);

    ServerConnection& server_;
    WorldFeed& feed_;
    const ReplayControl& replay_;
};

} // namespace evod::viewer
