// Simulations: the two simulation threads of a server and the ways to them. One thread owns the live worlds, the other
// one the replays. They share no mutable object: what one needs from the other goes as a message through the network
// thread.
//
// A server that shows a run file has only the thread of the replays, which then has all the time, and all worlds.
//
// Priority     the thread of the replays and its thread pool have a lower priority. Next to live worlds that keep all
//              processors busy, all replays together get about a sixth of the time; otherwise all that is left.
// Threads      the network thread calls all functions, except stop().
#pragma once

#include "server/metrics/worlds.h"
#include "server/runtime/demand.h"
#include "server/runtime/job_turns.h"
#include "server/runtime/mailbox.h"
#include "server/runtime/outbox.h"
#include "server/runtime/replay_loop.h"
#include "server/runtime/simulation_thread.h"
#include "server/runtime/unwritten_replies.h"

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string_view>
#include <thread>

namespace evod::runtime {

class Simulations {
  public:
    /// Of the thread of the replays and its pool. Linux then gives them 17 % of a processor that a live world also
    /// wants.
    static constexpr int replay_niceness = 7;

    /// shows_file  the server shows a run file: its only world is the replay of it.
    explicit Simulations(bool shows_file, std::size_t mailbox_capacity = mailbox_commands_max)
        : shows_file_{shows_file}, live_{Mailbox{mailbox_capacity}, {}}, replays_{Mailbox{mailbox_capacity}, {}} {}

    struct Start {
        base::Executor& executor; // for the live worlds; must outlive this object
        Clock& clock;             // must outlive this object
        LoopOutputs outputs;
        simulation::Laboratory laboratory;       // without the replays
        recording::Recorder* recorder = nullptr; // nullptr: runs are not stored
        std::optional<FileReplay> file = {};     // set if shows_file
    };
    /// Starts the threads.
    void start(Start with);
    /// Ends the threads after they have handled the remaining mail.
    void stop();

    /// The mailbox of the thread that has the world of this name, or would have it. Empty: the live worlds.
    Mailbox& mailbox_of(std::string_view world) { return part_of(world).mailbox; }
    /// Sends a command to the thread that carries it out. Returns false if its mailbox is full.
    bool try_send(CommandMail mail);
    /// Sends a request for a replay. Unlike a command, it may need the run of a live world first. Returns false if the
    /// mailbox is full.
    bool try_send(ReplayMail mail);
    /// Ends a replay that has lost its place, also one that is being opened.
    void end_replay(EndReplay mail) { replays_.mailbox.push(std::move(mail)); }
    /// Sets which worlds are streamed, and whether any session is subscribed to events.
    void set_demand(WorldDemands worlds, bool events_wanted);
    bool events_wanted() const { return replays_.demand.events_wanted(); }
    /// Must be called when a session has ended.
    void forget(std::uint64_t session);
    /// Takes the next reply from the outbox. Passes messages between the two threads on. Returns what can be answered
    /// now: replies that wait for the disk come back with their receipts.
    std::optional<Answer> pass_on(Reply reply);

    /// The places in the mailbox of the live worlds, by user.
    base::Quota mailbox_places() const { return (shows_file_ ? replays_ : live_).mailbox.places(); }
    /// The turns of all background jobs that compute.
    JobTurns& job_turns() { return job_turns_; }
    /// Calls `use` with the name and the handle of each running thread. Must not be called after stop().
    void for_each_thread(const std::function<void(const char* name, pthread_t)>& use);

    /// What the network thread shares with one simulation thread.
    struct Part {
        Mailbox mailbox;
        StreamDemand demand;
        std::unique_ptr<SimulationThread> thread = {}; // nullptr: it is not started
    };
    /// The part of the thread that has the world of this name, or would have it. Empty: the live worlds.
    Part& part_of(std::string_view world);

  private:
    const bool shows_file_;
    SteadyClock job_clock_;
    JobTurns job_turns_{JobTurns::count_for(std::thread::hardware_concurrency()), job_clock_};
    std::unique_ptr<base::Executor> replay_executor_;
    Part live_, replays_;
    UnwrittenReplies unwritten_;
    // By session: the requests for replays that wait for a run. A session that has ended has none.
    std::map<std::uint64_t, std::size_t> finding_;
};

} // namespace evod::runtime
