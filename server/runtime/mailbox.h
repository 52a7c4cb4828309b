// Mailbox: commands and queries on their way to the simulation thread, in order of arrival.
//
// Threads      any thread pushes; the simulation thread drains it between two ticks.
// Full         at `mailbox_commands_max` entries try_push() fails and the sender gets REASON_SERVER_BUSY.
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

/// A query. The simulation thread calls it between two ticks, when the query budget allows. Commands do not wait for
/// queries, so a session sends nothing more until its query is answered.
struct QueryMail {
    std::function<void(const simulation::Laboratory&)> ask;
};
/// A short call of another part of the server on the simulation thread.
struct CallMail {
    std::function<void()> call;
};

// Replays (replays.h).

/// Opens a replay of the run of `world`.
struct OpenReplay {
    std::string world;
    replay::WantedMoment at; // without fields: the first moment of the run
    std::uint64_t owner = 0; // the session, >= 1
};
/// Moves a replay to another moment.
struct Seek {
    std::string world;
    replay::WantedMoment to;
    std::uint64_t owner = 0; // the session, >= 1
};
struct CloseReplay {
    std::string world;
};
/// Closes all replays of a session that has ended, and cancels its seeks.
struct OwnerGone {
    std::uint64_t owner = 0;
};
/// Called on the simulation thread with the name of the replay, once it shows the moment.
using ReplayReply = std::function<void(const simulation::Laboratory&, const base::Result<std::string>& world)>;
struct ReplayMail {
    std::variant<OpenReplay, Seek, CloseReplay, OwnerGone> request;
    ReplayReply reply; // none for OwnerGone
};

struct FoundRun {
    replay::StoredRun run;
    std::uint64_t generation = 0; // of the world at the time of the request
};
/// Finds the stored run of a world, after everything recorded so far is on the disk or cannot be written.
struct FindRun {
    std::string world;
    std::function<void(const base::Result<FoundRun>&)> found; // called on the simulation thread
};

using Mail = std::variant<CommandMail, QueryMail, CallMail, ReplayMail, FindRun>;

class Mailbox {
  public:
    explicit Mailbox(std::size_t capacity = mailbox_commands_max) : capacity_{capacity} {}

    /// false: full; `mail` is unchanged.
    bool try_push(Mail&& mail);
    /// Ignores the capacity, for entries that are bounded elsewhere and must not be lost.
    void push(Mail&& mail);

    /// Makes wait() return without mail.
    void wake();

    /// Whether there is mail or a wake() that drain() has not seen; cheap enough for every tick.
    bool pending() const { return pending_.load(std::memory_order_acquire); }

    /// Everything that waits, oldest first. The result reuses the memory of `emptied`.
    std::vector<Mail> drain(std::vector<Mail> emptied = {});

    struct Fill {
        std::size_t waiting = 0, capacity = 0;
    };
    Fill fill() const;

    /// Returns when there is mail, after a wake(), or at `until`; nullopt: no time limit.
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
