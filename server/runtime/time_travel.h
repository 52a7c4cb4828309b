// Time travel: worlds that show the past of a run, beside those that live. A moment of the past is simulated again from
// the last one before it that the run's file tells, a slice at a time, so that nobody else waits for it.
//
// Owner        the simulation loop; on the simulation thread.
// Determinism  the past is made again bit for bit; living worlds are only looked at.
#pragma once

#include "server/runtime/mailbox.h"
#include "server/storage/past.h"
#include "server/storage/recorder.h"

#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace evod::runtime {

class TimeTravel {
  public:
    static constexpr std::size_t pasts_max = 4;         // of one client
    static constexpr std::size_t pasts_of_all_max = 64; // of all clients
    static constexpr std::size_t journeys_max = 64;     // under way at a time
    static constexpr std::chrono::milliseconds refresh_time{250};

    /// Everything handed in outlives this. recorder: nullptr if runs are not kept.
    TimeTravel(simulation::Laboratory& laboratory, Mailbox& mailbox, base::Executor& executor,
               storage::Recorder* recorder)
        : laboratory_{laboratory}, mailbox_{mailbox}, executor_{executor}, recorder_{recorder} {}

    /// A world that shows the run of a file and is there for good.
    struct Replay {
        std::string name;
        storage::Past past;
        storage::Rerun rerun;
        simulation::Recording recording;
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
    using Arrived = std::function<void(base::Result<storage::Rerun>)>;
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
        storage::Past past;
        storage::ComingChanges changes;
        std::uint64_t owner = 0; // 0: nobody's, there for good
        Clock::time_point refreshed;
        std::uint64_t journey = 0; // the newest to another moment
    };
    struct Journey {
        std::uint64_t number = 0;
        storage::Rerun rerun;
        storage::PastMoment to;
        Arrived arrived;
    };

    void open(const OpenPast& request, const PastReply& reply);
    void seek(const Seek& request, const PastReply& reply);
    base::Result<std::string> close(const ClosePast& request);
    void close_all_of(std::uint64_t owner);
    /// Where the past of a world is told; refused where it is not.
    base::Result<storage::Past> past_of(const std::string& world) const;
    /// Calls `then` on this thread with what there is to be seen of a world's run: all that has been, unless the disk
    /// makes trouble.
    using Seen = std::function<void(base::Result<simulation::Recording>, const storage::Past&)>;
    void look_at(const std::string& world, Seen then);
    std::uint64_t set_out(const storage::Past& past, const storage::PastMoment& to, Arrived arrived);
    /// A tick; true if the journey is over.
    static bool advance(Journey& journey, base::Executor& executor);
    void show(const std::string& name, storage::Past past, std::uint64_t owner, storage::Rerun rerun,
              const simulation::Recording& recording);
    void arrive_in(simulation::Entry& entry, Look& look, storage::Rerun rerun);
    void go_on(simulation::Entry& entry, Look& look);
    simulation::Entry* entry_of(const std::string& world);

    simulation::Laboratory& laboratory_;
    Mailbox& mailbox_;
    base::Executor& executor_;
    storage::Recorder* recorder_;
    std::map<std::string, Look, std::less<>> looks_; // by the name of the world that shows it
    std::map<std::uint64_t, std::size_t> opening_;   // how many are on their way, by who wants them and is still there
    std::map<std::uint64_t, std::function<void(bool all_is_written)>> waiting_; // for the disk
    std::vector<Journey> journeys_;
    std::vector<std::string> arrivals_;
    std::uint64_t last_journey_ = 0, last_look_ = 0, last_waiting_ = 0;
};

} // namespace evod::runtime
