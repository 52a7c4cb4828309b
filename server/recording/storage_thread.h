// Storage thread: writes what runs hand over to their files, several records a commit.
//
//   records wait → one transaction a run → commit → those who asked are told that it is on the disk
//
// A commit is made at once for a record that somebody waits for, else for what has come together in `gathering_time`.
//
// Names        a file that has been moved or deleted is trouble, too: what is written would be lost with the server. It
//              stays open, so that moving it back ends that.
// New files    a run is made as `NAME.evod-next` and gets its name when it is whole, so that what has that name and
//              holds nothing is damaged. Where it takes the place of another, the old one gets its end mark and its
//              other name first. So at every instant one of the two is the world's run; Archive::open() sees which
//              after a crash.
// Trouble      a write or commit that fails tells nobody anything. What was to be written is kept; the file is opened
//              anew and everything that may be missing written again, every `retry_time`, until it is there.
// Threads      handed to by one, the simulation thread, which never waits for the disk. Runs and their files belong to
//              this thread. What takes long it gives to the packing thread, and takes back what came of it: a
//              checkpoint compressed, or word that a log has been copied.
// In a hurry   what somebody waits for is written first, and nothing that nobody waits for takes longer than a commit
// of
//              `Options::part_bytes`: then it is looked whether somebody does. Exceptions are what one transaction has
//              to hold: the beginning and the outcome of a generation, which come before later commands; and a run that
//              is made or ends.
// Checkpoints  are large, take long to pack, and can be done without: they come after what all runs have to write, part
//              by part, each in a transaction of its own. Of a run, one waits at most, beside what the bound is for, so
//              that worlds need not stand still until it is written. One that is not written when its run ends is left
//              out, for a command waits; one whose server stops is written first.
// Logs         SQLite's write-ahead log is copied into its file when it has grown to `Options::log_pages_max`, by the
//              packing thread; nothing is written meanwhile but what runs have to say, so that it can begin anew. Where
//              it could not, as it was written to all the time, and is four times as long, this thread copies the rest.
// Full         has_room() is false from `waiting_bytes_max` on; whoever hands over stops making more.
// News         of both, trouble and room, are called out: whoever sleeps meanwhile can be woken.
#pragma once

#include "server/metrics/counters.h"
#include "server/recording/packing_thread.h"
#include "server/run_file/run_file.h"

#include <pthread.h>
#include <sys/types.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <variant>
#include <vector>

namespace evod::recording {

class StorageThread {
  public:
    static constexpr std::chrono::milliseconds gathering_time{200};
    static constexpr std::chrono::milliseconds retry_time{250};
    static constexpr std::chrono::seconds look_time{1}; // between two looks at whether a file still has its name
    static constexpr std::size_t waiting_bytes_max = 64 << 20;
    /// What takes more is written at once, so that fewer commands come while it is.
    static constexpr std::size_t gathered_bytes_max = 256 << 10;

    /// A run while its file is open here.
    using RunNumber = std::uint64_t;
    /// Called on the storage thread once the record is on the disk.
    using Done = std::function<void()>;
    using Record =
        std::variant<run_file::JournalEntry, run_file::Inherited, run_file::GenerationBegun, run_file::GenerationEnded,
                     run_file::HashLink, run_file::Checkpoint, run_file::StoredCheckpoint, run_file::EndMark>;
    /// What has become of a run's checkpoint; shared with whoever made it.
    struct CheckpointWriting {
        std::atomic<bool> waits = false;                                          // for the disk
        std::atomic<std::chrono::nanoseconds> took = std::chrono::nanoseconds{0}; // the last, to pack and to write
    };

    explicit StorageThread(run_file::RunFile::Options options, std::chrono::milliseconds retry_after = retry_time);
    /// As finish().
    ~StorageThread();
    /// Writes what waits, as far as that can be done now, and ends the thread. A run that fails keeps no other from being
    /// written. false: not all could be written; the log says what.
    bool finish();

    /// What is written in one transaction, or not at all. done: empty if nobody waits. One without records is done when
    /// everything handed over before is.
    struct Batch {
        std::vector<Record> records;
        Done done;
    };
    /// The end of what is handed over for a run: the file is closed, and renamed if `renamed` is given.
    struct Ending {
        Batch last; // its last record is the end mark
        std::string renamed;
    };

    /// A new file for a run, with what is to be in it from the beginning.
    RunNumber create(const std::string& path, run_file::RunIdentity identity, Batch first);
    /// The same in the place of another run, which ends.
    RunNumber replace(RunNumber old_run, Ending ending, const std::string& path, run_file::RunIdentity identity,
                      Batch first);
    /// A file that is there and has been read.
    RunNumber adopt(std::unique_ptr<run_file::RunFile> file);
    void write(RunNumber run, Batch batch);
    /// None of the run's waits any more. writing: waits, until it is on the disk.
    void write(RunNumber run, run_file::Checkpoint checkpoint, std::shared_ptr<CheckpointWriting> writing);
    void close(RunNumber run, Ending ending);

    /// Whether everything handed over is written, and nothing is left to be done.
    bool idle() const {
        return waiting_bytes_.load(std::memory_order_acquire) == 0 && waiting_checkpoints_.load() == 0 && !working_ &&
               away_ == 0;
    }
    /// What waits to be written, but for checkpoints.
    std::size_t waiting_bytes() const { return waiting_bytes_.load(std::memory_order_relaxed); }
    /// Since when the oldest of what waits has; nullopt: nothing waits.
    std::optional<std::chrono::steady_clock::time_point> waiting_since() const;
    /// What is counted of it; for any thread to read.
    struct Times {
        metrics::TimeHistogram journal_wait; // of commands, from when they were handed over until they are on the disk
        metrics::TimeHistogram commit;       // of what runs have to say, putting it on the disk included
    };
    const Times& times() const { return times_; }
    /// To ask the system about it.
    pthread_t handle() { return thread_.native_handle(); }
    pthread_t packing_handle() { return packing_.handle(); }
    bool has_room() const { return waiting_bytes_.load(std::memory_order_relaxed) < waiting_bytes_max; }
    /// Why nothing gets onto the disk at present; nothing if it does.
    std::optional<std::string> trouble() const;
    /// changed: called on the storage thread when trouble() says something else, or there is room again; must neither
    /// block nor call back. The one before is called no more once this returns.
    void when_changed(std::function<void()> changed);

  private:
    struct Item {
        std::optional<Record> record;
        Done done;
        std::shared_ptr<CheckpointWriting> writing; // of a checkpoint
        std::size_t bytes = 0;
        std::chrono::steady_clock::time_point handed_over = {}; // where somebody waits
        std::chrono::nanoseconds took{0};                       // of a checkpoint: to pack and to write
        bool away = false;                                      // a checkpoint that is being packed, and is empty here
    };
    /// What comes back from the packing thread.
    struct Packed {
        RunNumber run = 0;
        run_file::StoredCheckpoint checkpoint;
        std::chrono::nanoseconds took{0};
    };
    struct Closing {
        std::vector<Item> last;
        std::string renamed;
        bool replaced = false; // not before the run that takes its place says so
        bool marked = false, finished = false;
    };
    /// What has the name of a run's file, as long as that is open.
    struct Name {
        dev_t device;
        ino_t number;
        std::chrono::steady_clock::time_point looked = {};
        bool lost = false; // something else has, or nothing
    };
    struct Run {
        RunNumber number = 0;
        std::string path;
        std::optional<Name> known_as; // nullopt: to be looked at

        std::optional<run_file::RunIdentity> to_create;
        bool unnamed = false;                    // its file is one that is not whole yet, or still has the name of one
        std::optional<RunNumber> replaces;       // until it has taken the other's place
        std::unique_ptr<run_file::RunFile> file; // nullptr: to be opened, or created
        std::vector<Item> waiting;
        std::vector<Item> written;     // not told yet
        std::vector<Item> checkpoints; // that wait, once it has begun
        std::optional<Closing> closing;
        bool packing = false;          // one of its checkpoints is away
        bool copying = false;          // its log is being copied
        std::uint32_t pages_asked = 0; // the log held when it last was to be copied
        bool said_large = false;
    };

    std::vector<Item> items_of(Batch batch);
    RunNumber add(Run run, std::vector<Item> items, std::optional<std::pair<RunNumber, Closing>> old = std::nullopt);
    /// In one go, so that the storage thread takes all of it or nothing.
    void hand_over(RunNumber run, std::vector<Item> items);
    /// Whether the storage thread is to be woken. mutex_ is held.
    bool wait_in_line(RunNumber run, std::vector<Item> items);
    void work();
    /// Waits for something to do, unless there is more already, and takes what has come; whether the server stops.
    bool take(bool more);
    void take_back(Packed packed);
    void take_back_log(RunNumber run);
    /// Whether something is with the packing thread, or has been handed over and not taken.
    bool is_awaiting();
    bool somebody_waits();
    /// Writes what waits for all runs, but for checkpoints, until somebody waits for more; whether that happened.
    bool write_out();
    /// Of a run; false if that failed, or cannot be done yet.
    bool write_out(Run& run);
    /// Runs of the same path take the place NAME.evod-next one after another, in the order in which they were handed over: a
    /// run is not begun before those before it have ended, or, if it replaces the last of them, before that has its name.
    /// Helps those that are in its way; false: one of them is still there.
    bool is_its_turn(const Run& run);
    /// A little of what can wait, of one run after another; whether there was any.
    bool do_a_little();
    bool do_a_little(Run& run);
    /// Gives the next checkpoint of a run to the packing thread, if there is one that is not packed.
    void pack_next(Run& run);
    bool commit(Run& run, const std::vector<Item>& items);
    void copy_log_if_long(Run& run);
    /// Whether the file still has its name: one that was deleted or moved would be written for nobody.
    static std::optional<base::Refusal> mind_name(Run& run, std::chrono::steady_clock::time_point now);
    /// Gives a new file its name.
    bool take_place(Run& run);
    bool end(Run& run);
    void tell(std::vector<Item>& items);
    bool fail(Run& run, const base::Refusal& why);
    /// The same, and the file stays open.
    bool fail(const base::Refusal& why);
    /// Begins a transaction; where the file is not open it is opened, or made.
    base::Result<void> begin(Run& run);
    /// returns  whether it is a new one, with which a transaction has begun.
    base::Result<bool> open(Run& run);
    void wait_for_copy(Run& run);
    void leave_out_checkpoints(Run& run);
    void set_trouble(const std::string& why);
    /// At the end: what could not be written, run by run.
    void say_what_is_lost();

    const run_file::RunFile::Options options_;
    const std::chrono::milliseconds retry_after_;
    std::atomic<std::size_t> waiting_bytes_ = 0, waiting_checkpoints_ = 0;
    Times times_;                       // written by the storage thread
    std::atomic<bool> working_ = false; // the storage thread, or there is more for it to do

    mutable std::mutex mutex_; // guards what follows
    std::condition_variable changed_;
    std::map<RunNumber, std::vector<Item>> handed_over_;
    std::vector<Packed> packed_;
    std::vector<RunNumber> copied_; // whose logs have been
    // The oldest of handed_over_; of what the storage thread has taken and not written yet.
    std::optional<std::chrono::steady_clock::time_point> handed_over_since_, taken_since_;
    std::map<RunNumber, Run> new_runs_;
    std::map<RunNumber, Closing> closing_;
    RunNumber last_number_ = 0;
    bool urgent_ = false, stopping_ = false;
    std::string trouble_;
    std::function<void()> when_changed_;

    std::map<RunNumber, Run> runs_; // the storage thread's own
    // Of which run something was written last that nobody waited for; of which a little was done last.
    RunNumber last_written_ = 0, last_little_ = 0;
    std::atomic<std::size_t> away_ = 0; // what the packing thread was given and has not been taken back
    bool failed_ = false;               // something, the last time that everything was to be written
    bool advanced_ = false;             // something has been written since
    bool lost_ = false;                 // at the end, something could not be
    PackingThread packing_;             // its jobs use what stands before it
    std::thread thread_;                // last: it uses the rest
};

} // namespace evod::recording
