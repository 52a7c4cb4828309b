// RunHistory: keeps a History up to date with the server, with one query at a time.
//
// Owner        RunHistories of Panels, for the worlds on the screen; PlotsPanel, for the world it compares with.
// Threads      none; used on the drawing thread.
#pragma once

#include "client/viewer/panels/plots/history.h"
#include "client/viewer/world/poll.h"

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

namespace evod::viewer {

class RunHistory {
  public:
    /// Follows the run of the viewed world. Call it once per frame.
    void update(ViewedWorld& world, Poll::Clock::time_point now);
    /// Follows the run that set_run() was called with, which may be of another world of the server. Call it once per
    /// frame.
    void update_other(ViewedWorld& world, Poll::Clock::time_point now);
    void set_run(const evod::v1::WorldInfo& world) { history_.set_run(world); }

    const History& history() const { return history_; }
    const HistoryTable& table() const { return history_.table(); }
    /// Returns why the last query was refused or not answered, as a sentence; empty if it was answered.
    const std::string& problem() const { return poll_.problem(); }

  private:
    // Interval between queries, because a world may finish more generations per second than a user can see.
    static constexpr std::chrono::milliseconds poll_interval{100};

    void send_query(ViewedWorld& world, Poll::Clock::time_point now);

    History history_;
    Poll poll_{poll_interval};
    std::uint64_t place_ = 0; // place whose events have been processed
    std::uint64_t connected_count_ = 0;
    int frame_ = -1; // last frame number of Dear ImGui
};

/// The histories of the two worlds that had the focus last. The window shows at most two worlds, so a history is not
/// requested again when the focus moves to the other half and back.
class RunHistories {
  public:
    /// Returns the history of a world. The reference is valid until two other worlds have been passed in.
    RunHistory& of(const ViewedWorld& world);

  private:
    struct Entry {
        const ViewedWorld* world = nullptr; // only compared
        std::unique_ptr<RunHistory> history;
    };
    std::array<Entry, 2> entries_; // the world that had the focus last is the first
};

} // namespace evod::viewer
