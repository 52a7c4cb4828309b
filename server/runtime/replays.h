// Replays: worlds that show stored runs, beside the live worlds. To reach a moment, a seek simulates the run from the
// last stored state before that moment. It does so in short slices, so that other worlds continue meanwhile.
//
//   request → wait until everything recorded is on the disk → read the file → simulate up to the moment → show it
//
// Owner        the simulation loop, on the simulation thread.
// Threads      a job queue reads files. The results come back through the mailbox.
// Determinism  a seek reproduces a run bit for bit. It only reads live worlds and does not change them.
#pragma once

#include "server/jobs/job_queue.h"
#include "server/recording/recorder.h"
#include "server/replay/stored_run.h"
#include "server/runtime/mailbox.h"
#include "server/runtime/replies.h"

#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace evod::runtime {

class Replays {
  public:
    static constexpr std::size_t replays_max = 4;         // maximum per client
    static constexpr std::size_t replays_of_all_max = 64; // maximum of all clients together
    static constexpr std::size_t seeks_max = 64;          // seeks at the same time
    static constexpr std::chrono::milliseconds refresh_time{250};

    /// All arguments must outlive this object.
    ///
    /// recorder  nullptr if the server stores no runs.
    /// reply     receives the replies.
    Replays(simulation::Laboratory& laboratory, Mailbox& mailbox, base::Executor& executor,
            recording::Recorder* recorder, std::function<void(Reply)> reply)
        : laboratory_{laboratory}
        , mailbox_{mailbox}
        , executor_{executor}
        , recorder_{recorder}
        , reply_{std::move(reply)} {}

    /// The run of a file that the server shows as long as it runs.
    struct FileReplay {
        std::string name;
        replay::StoredRun run;
        replay::Rerun rerun;
        simulation::Replay replay;
    };
    /// Opens a replay that shows the first moment of the run, or of the given generation.
    static base::Result<FileReplay> replay_of(const std::string& path, std::optional<std::uint64_t> generation,
                                              base::Executor& executor);
    void show(FileReplay replay);

    void apply(const ReplayMail& mail);
    void find_run(const FindRun& mail);
    /// Closes all replays of a session that has ended, and cancels its seeks.
    void forget(std::uint64_t session);

    /// Must be called after every tick of a replay.
    void follow(simulation::Entry& entry);
    /// Reads new records for each running replay that has reached the end of its known records.
    ///
    /// returns  the time of the next call; nullopt: no call is needed.
    std::optional<Clock::time_point> refresh(Clock::time_point now);

    /// The result of a successful seek.
    struct SeekResult {
        replay::Rerun rerun;
        simulation::Replay there;
    };
    using SeekDone = std::function<void(base::Result<SeekResult>)>;
    /// Seeks to the first moment of a generation in the run of a world. finish_seeks() calls `done` later.
    void begin_seek(const std::string& world, std::uint64_t generation, SeekDone done);

    bool under_way() const { return !seeks_.empty(); }
    /// Advances all seeks in turn by one tick each, until `stop` returns true or all have reached their moments.
    void advance_seeks(const std::function<bool()>& stop);
    /// Calls `done` of each seek that advance_seeks() has ended. May create worlds.
    void finish_seeks();
    /// Called when nothing can be written to the disk. Requests that wait for the disk continue with the present file.
    void stop_waiting();

    /// Returns the replays that a seek has moved since the last call.
    std::vector<std::string> take_moved() { return std::exchange(moved_, {}); }

  private:
    struct Shown {
        replay::StoredRun run;
        replay::ComingChanges changes;
        std::uint64_t entries_read = 0; // number of journal entries that were read into `changes`
        std::uint64_t owner = 0;        // number of the session; 0: the server
        Clock::time_point refreshed;
        bool being_read = false;   // its new records are being read
        std::uint64_t running = 0; // number of its newest seek
    };
    struct RunningSeek {
        std::uint64_t number = 0, owner = 0;
        replay::Rerun rerun;
        replay::SeekTarget to;
        simulation::Replay there;
        SeekDone done;
    };
    struct FinishedSeek {
        SeekDone done;
        base::Result<SeekResult> result;
    };
    /// Called with the number of the seek before it begins. Returns false if the result is no longer needed.
    using Begun = std::function<bool(std::uint64_t number)>;
    /// A seek that waits until its run file has been read.
    struct PendingSeek {
        std::uint64_t owner = 0;
        Begun begun;
        SeekDone done;
    };

    void open(const OpenReplay& request, const ReplayMail& mail);
    void seek(const Seek& request, const ReplayMail& mail);
    base::Result<std::string> close(const CloseReplay& request);
    /// world  the name of the replay, once it shows the requested moment.
    void answer(const ReplayMail& mail, const base::Result<std::string>& world);
    /// The stored run of a world; refused if there is none.
    base::Result<replay::StoredRun> replay_of(const std::string& world) const;
    /// Calls `then` on the simulation thread once all records of the world are on the disk. Calls it with false at once
    /// if nothing can be written, or if the world has no file.
    void once_written(const std::string& world, std::function<void(bool all_is_written)> then);
    /// The present moment of the world, if it is live and has this run. Must be called before once_written().
    replay::RecordedUntil recorded_until(const std::string& world, const simulation::RunId& run_id) const;
    /// Reads a run file on the job queue, then begins the seek.
    ///
    /// to     nullopt: the first moment of the run.
    /// known  the argument of the same name of StoredRun::start_seek().
    void read_and_seek(const replay::StoredRun& run, const std::optional<replay::WantedMoment>& to,
                       replay::RecordedUntil known, std::uint64_t owner, SeekDone done, const Begun& begun = {});
    void begin(std::uint64_t number, base::Result<replay::SeekStart> start);
    /// Ends a running seek and replies with this refusal.
    void cancel(std::uint64_t number, const base::Refusal& why);
    static bool is_over(const RunningSeek& running);
    /// Simulates one tick of a seek.
    ///
    /// returns  whether the seek has ended. Every seek ends, whatever its target is.
    static bool advance(RunningSeek& running, base::Executor& executor);
    void show(const std::string& name, replay::StoredRun run, std::uint64_t owner, SeekResult result);
    void move_to(simulation::Entry& entry, Shown& shown, SeekResult result);
    void read_new_records(const std::string& name, Shown& shown);
    void extend(simulation::Entry& entry, Shown& shown, const replay::NewRecords& records);
    simulation::Entry* entry_of(const std::string& world);
    /// Runs `read` on the job queue, then runs the function that `read` returned on the simulation thread.
    void read_file(std::function<std::function<void()>()> read);

    simulation::Laboratory& laboratory_;
    Mailbox& mailbox_;
    base::Executor& executor_;
    recording::Recorder* recorder_;
    const std::function<void(Reply)> reply_;
    std::map<std::string, Shown, std::less<>> replays_; // key: name of the replay
    // The number of requests in progress. The key is the owner; a session that has ended has no entry.
    std::map<std::uint64_t, std::size_t> opening_, seeking_;
    std::map<std::uint64_t, std::function<void(bool all_is_written)>> waiting_; // requests that wait for the disk
    std::map<std::uint64_t, PendingSeek> pending_;                              // key: number of the seek
    std::vector<RunningSeek> seeks_;
    std::vector<FinishedSeek> finished_;
    std::vector<std::string> moved_;
    std::uint64_t last_seek_ = 0, last_name_ = 0, last_waiting_ = 0;
    jobs::JobQueue reader_{{.name = "replay"}}; // last member, because its jobs use the others
};

} // namespace evod::runtime
