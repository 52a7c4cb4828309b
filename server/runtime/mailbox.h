// Mailbox: a queue of commands and queries for the simulation thread, in order of arrival.
//
// Threads      any thread adds mail. The simulation thread removes it between two ticks.
// Full         when it contains `mailbox_commands_max` entries, try_push() fails and the sender receives
//              REASON_SERVER_BUSY.
#pragma once

#include "server/base/result.h"
#include "server/replay/stored_run.h"
#include "server/runtime/clock.h"
#include "server/runtime/commands.h"
#include "server/simulation/laboratory.h"

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <variant>
#include <vector>

namespace evod::runtime {

constexpr std::size_t mailbox_commands_max = 1024;

/// A query. The simulation thread calls it between two ticks, when the query budget allows it. Commands do not wait for
/// queries, so a session passes on no further requests until its query is answered.
struct QueryMail {
    std::function<void(const simulation::Laboratory&)> ask;
};
/// A short function that another part of the server runs on the simulation thread.
struct CallMail {
    std::function<void()> call;
};

// Requests for replays (replays.h).

/// A request to open a replay of the run of the world `world`.
struct OpenReplay {
    std::string world;
    replay::WantedMoment at; // the first moment to show; without fields: the first moment of the run
    std::uint64_t owner = 0; // number of the session, >= 1
};
/// A request to move a replay to another moment.
struct Seek {
    std::string world;
    replay::WantedMoment to;
    std::uint64_t owner = 0; // number of the session, >= 1
};
struct CloseReplay {
    std::string world;
};
/// A request to close all replays of a session that has ended, and to cancel its seeks.
struct OwnerGone {
    std::uint64_t owner = 0;
};
/// Called on the simulation thread with the name of the replay, once the replay shows the requested moment.
using ReplayReply = std::function<void(const simulation::Laboratory&, const base::Result<std::string>& world)>;
struct ReplayMail {
    std::variant<OpenReplay, Seek, CloseReplay, OwnerGone> request;
    ReplayReply reply; // not set for OwnerGone
};

struct FoundRun {
    replay::StoredRun run;
    std::uint64_t generation = 0; // generation of the world when the request was handled
};
/// A request to find the stored run of a world. The reply waits until everything recorded so far is on the disk, or until
/// writing fails.
struct FindRun {
    std::string world;
    std::function<void(const base::Result<FoundRun>&)> found; // called on the simulation thread
};

using Mail = std::variant<CommandMail, QueryMail, CallMail, ReplayMail, FindRun>;

class Mailbox {
  public:
    explicit Mailbox(std::size_t capacity = mailbox_commands_max) : capacity_{capacity} {}

    /// Adds mail. Returns false if the mailbox is full; `mail` is then unchanged.
    bool try_push(Mail&& mail);
    /// Adds mail regardless of the capacity. For entries whose number is bounded elsewhere and that must not be lost.
    void push(Mail&& mail);

    /// Makes wait() return even if there is no mail.
    void wake();

    /// Whether mail or a wake() has arrived since the last drain(). It is cheap enough to be called in every tick.
    bool pending() const { return pending_.load(std::memory_order_acquire); }

    /// Removes and returns all entries, oldest first. The result reuses the memory of `emptied`.
    std::vector<Mail> drain(std::vector<Mail> emptied = {});

    struct Fill {
        std::size_t waiting = 0, capacity = 0;
    };
    Fill fill() const;

    /// Waits until there is mail, wake() is called, or the time `until` is reached; nullopt: no time limit.
    void wait(std::optional<Clock::time_point> until);

  private:
    bool push(Mail&& mail, std::size_t capacity);

    const std::size_t capacity_;
    std::atomic<bool> pending_ = false;
    mutable std::mutex mutex_; // guards the members below
    std::condition_variable changed_;
    std::vector<Mail> waiting_;
};

} // namespace evod::runtime
