// Replays: worlds that show stored runs, beside the worlds that live. A seek simulates a moment again from the last
// stored state before it, a slice at a time, so that other worlds continue meanwhile.
//
//   request → everything recorded is on the disk → the file is read → simulated up to the moment → shown
//
// Owner        the simulation loop; used on the simulation thread.
// Threads      a job queue reads files; results come back through the mailbox.
// Determinism  a seek reproduces a run bit for bit; it only reads living worlds.
#pragma once

#include "server/jobs/job_queue.h"
#include "server/recording/recorder.h"
#include "server/replay/stored_run.h"
#include "server/runtime/mailbox.h"

#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace evod::runtime {

class Replays {
  public:
    static constexpr std::size_t replays_max = 4;         // of one client
    static constexpr std::size_t replays_of_all_max = 64; // of all clients
    static constexpr std::size_t seeks_max = 64;          // at a time
    static constexpr std::chrono::milliseconds refresh_time{250};

    /// Everything passed in outlives this. recorder: nullptr if the server keeps no runs.
    Replays(simulation::Laboratory& laboratory, Mailbox& mailbox, base::Executor& executor,
            recording::Recorder* recorder)
        : laboratory_{laboratory}, mailbox_{mailbox}, executor_{executor}, recorder_{recorder} {}

    /// The run of a file, shown as long as the server runs.
    struct FileReplay {
        std::string name;
        replay::StoredRun run;
        replay::Rerun rerun;
        simulation::Replay replay;
    };
    /// A replay at the first moment of the run, or of a generation.
    static base::Result<FileReplay> replay_of(const std::string& path, std::optional<std::uint64_t> generation,
                                              base::Executor& executor);
    void show(FileReplay replay);

    void apply(ReplayMail mail);
    void find_run(const FindRun& mail);

    /// To be called after every tick of a replay.
    void follow(simulation::Entry& entry);
    /// Reads new records for replays that have reached the end of what is known and continue to run.
    ///
    /// returns  when to call it again.
    std::optional<Clock::time_point> refresh(Clock::time_point now);

    /// The end of a successful seek.
    struct SeekResult {
        replay::Rerun rerun;
        simulation::Replay there;
    };
    using SeekDone = std::function<void(base::Result<SeekResult>)>;
    /// Seeks to the first moment of a generation of a world's run. Calls `done` in a later slice.
    void begin_seek(const std::string& world, std::uint64_t generation, SeekDone done);

    bool under_way() const { return !seeks_.empty(); }
    /// Advances every seek in turn by one tick, until `stop` returns true or all are done.
    void advance_seeks(const std::function<bool()>& stop);
    /// Nothing can be written at present: requests that wait for the disk continue with what it has now.
    void stop_waiting();

    /// The replays that a seek has moved since the last call.
    std::vector<std::string> take_moved() { return std::exchange(moved_, {}); }

  private:
    struct Shown {
        replay::StoredRun run;
        replay::ComingChanges changes;
        std::uint64_t entries_read = 0; // of the journal, into `changes`
        std::uint64_t owner = 0;        // a session; 0: the server
        Clock::time_point refreshed;
        bool being_read = false;   // its new records are
        std::uint64_t running = 0; // number of its newest seek
    };
    struct RunningSeek {
        std::uint64_t number = 0, owner = 0;
        replay::Rerun rerun;
        replay::SeekTarget to;
        simulation::Replay there;
        SeekDone done;
    };
    /// Called with the seek's number before it begins. Returns whether its result is still wanted.
    using Begun = std::function<bool(std::uint64_t number)>;
    /// A seek whose file is being read.
    struct PendingSeek {
        std::uint64_t owner = 0;
        Begun begun;
        SeekDone done;
    };

    void open(const OpenReplay& request, const ReplayReply& reply);
    void seek(const Seek& request, const ReplayReply& reply);
    base::Result<std::string> close(const CloseReplay& request);
    void close_all_of(std::uint64_t owner);
    /// The stored run of a world; refused if there is none.
    base::Result<replay::StoredRun> replay_of(const std::string& world) const;
    /// Calls `then` on this thread once everything that the world has done is on the disk; with false if that is not
    /// known, because nothing can be written or the world has no file.
    void once_written(const std::string& world, std::function<void(bool all_is_written)> then);
    /// The present moment of a world that lives and has this run. To be called before once_written().
    replay::RecordedUntil recorded_until(const std::string& world, const simulation::RunId& run_id) const;
    /// Reads a run's file on the job queue, then begins to seek.
    ///
    /// to     nothing: the first moment.
    /// known  as StoredRun::start_seek() takes it.
    void read_and_seek(const replay::StoredRun& run, const std::optional<replay::WantedMoment>& to,
                       replay::RecordedUntil known, std::uint64_t owner, SeekDone done, const Begun& begun = {});
    void begin(std::uint64_t number, base::Result<replay::SeekStart> start);
    /// Ends a running seek with this refusal.
    void cancel(std::uint64_t number, const base::Refusal& why);
    static bool is_over(const RunningSeek& running);
    /// Simulates one tick.
    ///
    /// returns  whether the seek is over; every seek ends, whatever its target.
    static bool advance(RunningSeek& running, base::Executor& executor);
    void show(const std::string& name, replay::StoredRun run, std::uint64_t owner, SeekResult result);
    void move_to(simulation::Entry& entry, Shown& shown, SeekResult result);
    void read_new_records(const std::string& name, Shown& shown);
    void extend(simulation::Entry& entry, Shown& shown, const replay::NewRecords& records);
    simulation::Entry* entry_of(const std::string& world);
    /// Runs `read` on the job queue, and what it returns on this thread.
    void read_file(std::function<std::function<void()>()> read);

    simulation::Laboratory& laboratory_;
    Mailbox& mailbox_;
    base::Executor& executor_;
    recording::Recorder* recorder_;
    std::map<std::string, Shown, std::less<>> replays_; // by the name of the replay
    // The numbers of requests under way, by owner; a session that has ended has none.
    std::map<std::uint64_t, std::size_t> opening_, seeking_;
    std::map<std::uint64_t, std::function<void(bool all_is_written)>> waiting_; // for the disk
    std::map<std::uint64_t, PendingSeek> pending_;                              // by the number of the seek
    std::vector<RunningSeek> seeks_;
    std::vector<std::string> moved_;
    std::uint64_t last_seek_ = 0, last_name_ = 0, last_waiting_ = 0;
    jobs::JobQueue reader_{{.name = "replay"}}; // last: its jobs use the rest
};

} // namespace evod::runtime
