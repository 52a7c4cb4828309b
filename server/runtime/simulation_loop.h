// Simulation loop: what the simulation thread does between two sleeps. Owns the laboratory and decides when a world
// advances; what happens when it does is the laboratory's business and does not depend on this.
//
//   commands → queries → how it stands with the disk → paced worlds that are due → worlds at full speed and those that
//   show the past, a slice each → journeys into the past, a slice → queries → events and snapshots into the outbox →
//   sleep until the next is due
//
// Pace         a world at speed factor f takes a tick every tick_s / f. One that falls behind is given at most
//              `catch_up_max` of lost time back; beyond that its clock is slow. A slice ends when mail comes or another
//              world is due, so answers and paced worlds wait for one tick of another world at most. Until then all
//              that have no pace to keep are given equal slices, and of each a tick.
// Queries      are answered in the time that no world wants, and for a share of the other (query_budget.h).
// Disk         while it has no room for what worlds have to say, those that live stand still. Mail, worlds that show
//              the past, and pictures for who comes new go on.
// Threads      called by one; that is the simulation thread.
// Determinism  time decides how many ticks are taken, never what is in them.
#pragma once

#include "server/base/executor.h"
#include "server/metrics/worlds.h"
#include "server/recording/recorder.h"
#include "server/runtime/clock.h"
#include "server/runtime/demand.h"
#include "server/runtime/mailbox.h"
#include "server/runtime/query_budget.h"
#include "server/runtime/replays.h"
#include "server/runtime/snapshot.h"
#include "server/simulation/laboratory.h"

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>

namespace evod::runtime {

/// Where the loop's news go; called on the simulation thread.
struct LoopOutputs {
    std::function<void(const simulation::Laboratory&, std::vector<simulation::Event>)> events;
    std::function<void(SnapshotPtr)> picture;
    /// It stands otherwise with writing down what worlds do.
    std::function<void(const simulation::Storage&)> storage = [](const simulation::Storage&) {};
    /// What is counted of each world, but of those that look back; outlives the loop. nullptr: nothing is.
    metrics::Worlds* counted = nullptr;
};

class SimulationLoop {
  public:
    static constexpr std::chrono::milliseconds slice{5};
    static constexpr std::chrono::milliseconds catch_up_max{50};
    /// A world at full speed goes on for about so long before the clock is looked at: in a small one, a tick takes not
    /// much longer than a look.
    static constexpr std::chrono::microseconds between_looks{20};
    /// A world whose clock loses more than this part of the time is said to be slowed.
    static constexpr double slowed_from = 0.02;
    /// Worlds that wait for a disk which does write, as they do now and then, are worth telling of only after this.
    static constexpr std::chrono::seconds slow_disk_patience{1};

    /// Everything handed in outlives the loop.
    ///
    /// laboratory  with the worlds that are there from the beginning.
    /// recorder    what is done is written down there, and commands are answered once they are; nullptr: nothing is.
    /// replay      a world that shows the run of a file.
    SimulationLoop(Mailbox& mailbox, StreamDemand& demand, base::Executor& executor, Clock& clock, LoopOutputs outputs,
                   simulation::Laboratory laboratory = {}, recording::Recorder* recorder = nullptr,
                   std::optional<Replays::FileReplay> replay = {});

    /// Minds the mail and advances what is due, for about a slice per world. Returns when it wants to be called again
    /// if nothing comes; nullopt: not until then.
    std::optional<Clock::time_point> pass();

    /// Carries out commands; queries wait for answer_queries().
    void mind_mail();
    /// At the end: minds the mail that waits, and closes what is recorded.
    void close();

    const simulation::Laboratory& laboratory() const { return laboratory_; }

  private:
    /// What is known of a world here; by name, and forgotten when the run id is another.
    struct Track {
        recording::RunRecorder* recorder = nullptr;
        std::shared_ptr<metrics::World> counted; // nullptr: nothing is
        simulation::RunId run_id;
        simulation::Speed speed;
        double tick_s = 0;
        bool running = false;
        Clock::time_point due; // its next tick, if it is paced
        // Ticks in the second that is being measured.
        Clock::time_point measured_since;
        std::uint64_t ticks = 0;
        Clock::duration lost{};         // that its clock was slowed by
        std::uint32_t ticks_a_look = 1; // at full speed
        // For those who watch.
        const WorldDemand* watch = nullptr;
        std::uint64_t newcomers_served = 0;
        bool changed = true; // since the last picture, by a command or a goal
        std::uint64_t pictured_tick = 0;
        Clock::time_point next_picture;
    };

    /// Answers queries as far as there is time for them. Returns when the next pass is to come for them; nullopt: it
    /// need not.
    std::optional<Clock::time_point> answer_queries();
    void answer_query();
    /// Whether a world is late if something else is done now.
    bool time_is_wanted(Clock::time_point now) const;
    void apply(CommandMail& mail);
    void fork(CommandMail& mail);
    base::Result<simulation::Applied> apply(const simulation::Command& command);
    /// The run of a command's world before the command.
    struct RunBefore {
        simulation::RunId run_id;
        std::uint64_t tick;
    };
    std::optional<RunBefore> run_of(const simulation::Command& command) const;
    const simulation::Entry* entry_in(const simulation::Command& command) const;
    /// Why a command cannot be taken now, whatever it is.
    std::optional<base::Refusal> refusal_of(const simulation::Command& command) const;
    void answer(CommandMail& mail, const base::Result<simulation::Applied>& applied,
                const std::optional<RunBefore>& before);
    /// Writes down a command that was applied.
    void record(CommandMail& mail, const simulation::Applied& applied, CommandAnswer answer,
                const std::optional<RunBefore>& before);
    void mind_arrivals();
    void mind_demand();
    void mind_storage();
    /// Whether it must not advance now, whatever it wants.
    bool waits_for_the_disk(const simulation::Entry& entry) const { return worlds_wait_ && !entry.replay; }
    void follow_worlds();
    Track& follow(simulation::Entry& entry);
    void advance_slice(simulation::Entry& entry, Track& track, Clock::time_point end);
    /// spent: on the ticks since the last look at the clock, and all that came with them.
    void mind_checkpoint(const simulation::Entry& entry, Track& track, Clock::duration spent);
    void measure(simulation::Entry& entry, Track& track, Clock::time_point now);
    void show(const simulation::Entry& entry, Track& track, Clock::time_point now);
    void tell_events();
    Clock::duration period(const simulation::Entry& entry) const;

    Mailbox& mailbox_;
    StreamDemand& demand_;
    base::Executor& executor_;
    Clock& clock_;
    const LoopOutputs outputs_;
    simulation::Laboratory laboratory_;
    recording::Recorder* recorder_;
    bool worlds_wait_ = false;                       // those that live, for the disk
    std::optional<Clock::time_point> waiting_since_; // for one that does write
    Replays replays_;
    std::map<std::string, Track, std::less<>> tracks_;
    WorldDemands watches_;
    SnapshotPool pool_;
    std::vector<Mail> mail_;
    std::deque<QueryMail> queries_; // one of a session at most
    QueryBudget query_budget_;
    std::vector<std::uint32_t> island_indices_; // working memory
};

} // namespace evod::runtime
