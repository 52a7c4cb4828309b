// Storage thread: writes what runs hand over to their files, several records a commit.
//
//   records wait → one transaction a run → commit → those who asked are told that it is on the disk
//
// A commit is made at once for a record that somebody waits for, else for what has come together in `gathering_time`.
//
// New files    a run is made as `NAME.evod-next` and gets its name when it is whole, so that what has that name and
//              holds nothing is damaged. Where it takes the place of another, the old one gets its end mark and its
//              other name first. So at every instant one of the two is the world's run; Archive::open() sees which
//              after a crash.
// Trouble      a write or commit that fails tells nobody anything. What was to be written is kept; the file is opened
//              anew and everything that may be missing written again, every `retry_time`, until it is there.
// Threads      handed to by one, the simulation thread, which never waits for the disk; files belong to this thread.
// Checkpoints  are large, take long to pack, and can be done without: they come after what all runs have to write, each
//              in a transaction of its own. Of a run, one waits at most, beside what the bound is for, so that worlds
//              need not stand still until it is written.
// Full         has_room() is false from `waiting_bytes_max` on; whoever hands over stops making more.
// News         of both, trouble and room, are called out: whoever sleeps meanwhile can be woken.
#pragma once

#include "server/storage/run_file.h"

#include <pthread.h>

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

namespace evod::storage {

class StorageThread {
  public:
    static constexpr std::chrono::milliseconds gathering_time{200};
    static constexpr std::chrono::milliseconds retry_time{250};
    static constexpr std::size_t waiting_bytes_max = 64 << 20;

    /// A run while its file is open here.
    using RunNumber = std::uint64_t;
    /// Called on the storage thread once the record is on the disk.
    using Done = std::function<void()>;
    using Record =
        std::variant<JournalEntry, Inherited, GenerationBegun, GenerationEnded, HashLink, Checkpoint, EndMark>;
    /// What has become of a run's checkpoint; shared with whoever made it.
    struct CheckpointWriting {
        std::atomic<bool> waits = false;                                          // for the disk
        std::atomic<std::chrono::nanoseconds> took = std::chrono::nanoseconds{0}; // the last, to pack and to write
    };

    explicit StorageThread(RunFile::Options options, std::chrono::milliseconds retry_after = retry_time);
    /// Writes what waits, as far as that can be done now, and ends.
    ~StorageThread();

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
    RunNumber create(const std::string& path, RunIdentity identity, Batch first);
    /// The same in the place of another run, which ends.
    RunNumber replace(RunNumber old_run, Ending ending, const std::string& path, RunIdentity identity, Batch first);
    /// A file that is there and has been read.
    RunNumber adopt(std::unique_ptr<RunFile> file);
    void write(RunNumber run, Batch batch);
    /// None of the run's waits any more. writing: waits, until it is on the disk.
    void write(RunNumber run, Checkpoint checkpoint, std::shared_ptr<CheckpointWriting> writing);
    void close(RunNumber run, Ending ending);

    /// Whether everything handed over is written.
    bool idle() const {
        return waiting_bytes_.load(std::memory_order_acquire) == 0 && waiting_checkpoints_.load() == 0;
    }
    /// What waits to be written, but for checkpoints.
    std::size_t waiting_bytes() const { return waiting_bytes_.load(std::memory_order_relaxed); }
    /// Since when the oldest of what waits has; nullopt: nothing waits.
    std::optional<std::chrono::steady_clock::time_point> waiting_since() const;
    /// To ask the system about it.
    pthread_t handle() { return thread_.native_handle(); }
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
    };
    struct Closing {
        std::vector<Item> last;
        std::string renamed;
        bool replaced = false; // not before the run that takes its place says so
        bool marked = false, finished = false;
    };
    struct Run {
        std::string path;
        std::optional<RunIdentity> to_create;
        bool unnamed = false;              // its file is one that is not whole yet, or still has the name of one
        std::optional<RunNumber> replaces; // until it has taken the other's place
        std::unique_ptr<RunFile> file;     // nullptr: to be opened, or created
        std::vector<Item> waiting;
        std::vector<Item> written;     // not told yet
        std::vector<Item> checkpoints; // that wait, once it has begun
        std::optional<Closing> closing;
        std::chrono::nanoseconds commit_took{0};
        bool said_large = false;
    };

    std::vector<Item> items_of(Batch batch);
    RunNumber add(Run run, std::vector<Item> items, std::optional<std::pair<RunNumber, Closing>> old = std::nullopt);
    /// In one go, so that the storage thread takes all of it or nothing.
    void hand_over(RunNumber run, std::vector<Item> items);
    /// Whether the storage thread is to be woken. mutex_ is held.
    bool wait_in_line(RunNumber run, std::vector<Item> items);
    void work();
    /// Writes what waits for a run, but for checkpoints; false if that failed.
    bool write_out(Run& run);
    /// The same of its checkpoints, if all else is written.
    bool write_checkpoints(Run& run);
    bool commit(Run& run, const std::vector<Item>& items);
    /// Gives a new file its name.
    bool take_place(Run& run);
    bool end(Run& run);
    void tell(const Run& run, std::vector<Item>& items);
    bool fail(Run& run, const base::Refusal& why);
    /// Begins a transaction; where the file is not open it is opened, or made.
    base::Result<void> begin(Run& run);
    void set_trouble(const std::string& why);

    const RunFile::Options options_;
    const std::chrono::milliseconds retry_after_;
    std::atomic<std::size_t> waiting_bytes_ = 0, waiting_checkpoints_ = 0;

    mutable std::mutex mutex_; // guards what follows
    std::condition_variable changed_;
    std::map<RunNumber, std::vector<Item>> handed_over_;
    // The oldest of handed_over_; of what the storage thread has taken and not written yet.
    std::optional<std::chrono::steady_clock::time_point> handed_over_since_, taken_since_;
    std::map<RunNumber, Run> new_runs_;
    std::map<RunNumber, Closing> closing_;
    RunNumber last_number_ = 0;
    bool urgent_ = false, stopping_ = false;
    std::string trouble_;
    std::function<void()> when_changed_;

    std::map<RunNumber, Run> runs_; // the storage thread's own
    bool failed_ = false;           // something, the last time that everything was to be written
    std::thread thread_;            // last: it uses the rest
};

} // namespace evod::storage
