// Mailbox: commands and queries on their way to the simulation thread, in the order in which they came.
//
// Threads      pushed to by any, drained by the simulation thread between two ticks.
// Full         at `mailbox_commands_max` waiting, the next is refused; its sender is told "busy" at once.
#pragma once

#include "server/base/result.h"
#include "server/replay/stored_run.h"
#include "server/runtime/clock.h"
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

/// The answer to a command, and how to give it to whoever waits for it.
struct CommandAnswer {
    std::string frame;
    std::function<void()> give; // called on the simulation thread or the storage thread; must not block
};

/// Called on the simulation thread as soon as the command is applied or refused: what it reads of the laboratory is the
/// state in which the command begins to hold. The answer is given at once, or when the command is on the disk.
///
/// command  as applied: it names its world.
using CommandReply = std::function<CommandAnswer(const simulation::Laboratory&, const simulation::Command& command,
                                                 const base::Result<simulation::Applied>&)>;

struct CommandMail {
    simulation::Command command;
    run_file::Origin origin;
    CommandReply reply;
};

/// A client reads; called on the simulation thread between two ticks, when the query budget allows it. Commands do not
/// wait for it, so a session sends nothing more until it is answered.
struct QueryMail {
    std::function<void(const simulation::Laboratory&)> ask;
};
/// Another part of the server continues on the simulation thread; must be short.
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

    /// false: full, and nothing was taken from `mail`.
    bool try_push(Mail&& mail);
    /// The same however full: for what is bounded elsewhere, and must not be lost.
    void push(Mail&& mail);

    /// Makes wait() return: something else than mail wants to be looked at.
    void wake();

    /// Whether there is something to drain or a wake() to mind; cheap enough to ask after every tick.
    bool pending() const { return pending_.load(std::memory_order_acquire); }

    /// Everything that waits, oldest first. `emptied` lends its memory.
    std::vector<Mail> drain(std::vector<Mail> emptied = {});

    struct Fill {
        std::size_t waiting = 0, capacity = 0;
    };
    Fill fill() const;

    /// Returns when there is mail, after a wake(), or at `until`; nullopt is never.
    void wait(std::optional<Clock::time_point> until);

  private:
    bool push(Mail&& mail, std::size_t capacity);

    const std::size_t capacity_;
    std::atomic<bool> pending_ = false;
    mutable std::mutex mutex_; // guards what follows
    std::condition_variable changed_;
    std::vector<Mail> waiting_;
};

} // namespace evod::runtime
