// Time travel: worlds that show the past of a run, beside those that live. A moment of the past is simulated again from
// the last one before it that the run's file tells, a slice at a time, so that nobody else waits for it.
//
//   asked for → all that has been is on the disk → its file is read → simulated up to the moment → there
//
// Owner        the simulation loop; on the simulation thread.
// Threads      files are read by the past reader's.
// Determinism  the past is made again bit for bit; living worlds are only looked at.
#pragma once

#include "server/recording/recorder.h"
#include "server/replay/past.h"
#include "server/runtime/mailbox.h"
#include "server/runtime/past_reader.h"

#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace evod::runtime {

class TimeTravel {
  public:
    static constexpr std::size_t replays_max = 4;       // of one client
    static constexpr std::size_t pasts_of_all_max = 64; // of all clients
    static constexpr std::size_t journeys_max = 64;     // under way at a time
    static constexpr std::chrono::milliseconds refresh_time{250};

    /// Everything handed in outlives this. recorder: nullptr if runs are not kept.
    TimeTravel(simulation::Laboratory& laboratory, Mailbox& mailbox, base::Executor& executor,
               recording::Recorder* recorder)
        : laboratory_{laboratory}, mailbox_{mailbox}, executor_{executor}, recorder_{recorder}, reader_{mailbox} {}

    /// A world that shows the run of a file and is there for good.
    struct Replay {
        std::string name;
        replay::Past past;
        replay::Rerun rerun;
        simulation::Replay replay;
    };
    /// At its first moment, or that of a generation.
    static base::Result<Replay> replay_of(const std::string& path, std::optional<std::uint64_t> generation,
                                          base::Executor& executor);
    void show(Replay replay);

    void apply(PastMail mail);
    void find_run(const FindRun& mail);

    /// To be called after every tick of a world that shows the past.
    void follow(simulation::Entry& entry);
    /// Worlds that stand at the end of what was known and want to go on: whether there is more. Returns when to look
    /// again.
    std::optional<Clock::time_point> refresh(Clock::time_point now);

    /// A journey's end, or why it came to none.
    struct Arrival {
        replay::Rerun rerun;
        simulation::Replay there;
    };
    using Arrived = std::function<void(base::Result<Arrival>)>;
    /// To the first moment of a generation of a world's run. `arrived` is called in a later slice.
    void begin_journey(const std::string& world, std::uint64_t generation, Arrived arrived);

    bool under_way() const { return !journeys_.empty(); }
    /// Goes on with every journey in turn, a tick each, until `stop` says so or all are at their end.
    void travel(const std::function<bool()>& stop);
    /// The disk makes trouble: who waits for it to tell of a past is shown what it tells now.
    void stop_waiting();

    /// Worlds that have been taken to another moment since this was last called.
    std::vector<std::string> take_arrivals() { return std::exchange(arrivals_, {}); }

  private:
    struct Look {
        replay::Past past;
        replay::ComingChanges changes;
        std::uint64_t entries_read = 0; // of the journal, into `changes`
        std::uint64_t owner = 0;        // 0: nobody's, there for good
        Clock::time_point refreshed;
        bool being_read = false;   // what it has come to
        std::uint64_t journey = 0; // the newest to another moment
    };
    struct Journey {
        std::uint64_t number = 0, owner = 0; // owner 0: the server itself
        replay::Rerun rerun;
        replay::PastMoment to;
        simulation::Replay there;
        Arrived arrived;
    };
    /// Called with the journey's number before it begins. Returns whether its arrival is still wanted.
    using Departed = std::function<bool(std::uint64_t number)>;
    /// A journey that begins once the file has been read.
    struct Departing {
        std::uint64_t owner = 0;
        Departed departed;
        Arrived arrived;
    };

    void open(const OpenReplay& request, const PastReply& reply);
    void seek(const Seek& request, const PastReply& reply);
    base::Result<std::string> close(const CloseReplay& request);
    void close_all_of(std::uint64_t owner);
    /// Where the past of a world is told; refused where it is not.
    base::Result<replay::Past> replay_of(const std::string& world) const;
    /// Calls `then` on this thread when all that a world has done is on the disk; with false if nobody knows, because
    /// the disk makes trouble, or nothing of it is written.
    void once_written(const std::string& world, std::function<void(bool all_is_written)> then);
    /// Where a world is, if it lives and this is its run. To be called before once_written().
    replay::KnownUntil known_of(const std::string& world, const simulation::RunId& run_id) const;
    /// to     nothing: the first moment.
    /// known  as Past::depart takes it.
    void set_out(const replay::Past& past, const std::optional<replay::WantedMoment>& to, replay::KnownUntil known,
                 std::uint64_t owner, Arrived arrived, const Departed& departed = {});
    void depart(std::uint64_t number, base::Result<replay::Departure> departure);
    /// Ends a journey that is still under way with this refusal.
    void give_up(std::uint64_t number, const base::Refusal& why);
    /// Whether a journey is over: at its moment, or beyond it.
    static bool is_over(const Journey& journey);
    /// A tick; true if the journey is over. Every journey ends, whatever moment it goes to.
    static bool advance(Journey& journey, base::Executor& executor);
    void show(const std::string& name, replay::Past past, std::uint64_t owner, Arrival arrival);
    void arrive_in(simulation::Entry& entry, Look& look, Arrival arrival);
    void ask_for_news(const std::string& name, Look& look);
    void go_on(simulation::Entry& entry, Look& look, const replay::PastNews& news);
    simulation::Entry* entry_of(const std::string& world);

    simulation::Laboratory& laboratory_;
    Mailbox& mailbox_;
    base::Executor& executor_;
    recording::Recorder* recorder_;
    std::map<std::string, Look, std::less<>> looks_; // by the name of the world that shows it
    // How many are on their way, by the owner; one that is gone is not in them.
    std::map<std::uint64_t, std::size_t> opening_, seeking_;
    std::map<std::uint64_t, std::function<void(bool all_is_written)>> waiting_; // for the disk
    std::map<std::uint64_t, Departing> departing_;                              // by the number of the journey
    std::vector<Journey> journeys_;
    std::vector<std::string> arrivals_;
    std::uint64_t last_journey_ = 0, last_look_ = 0, last_waiting_ = 0;
    PastReader reader_; // last: what it reads comes back here
};

} // namespace evod::runtime
