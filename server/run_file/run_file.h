// Run file: one world's run as an SQLite database, `NAME.evod`. Tables and columns: docs/RUN_FILE.md.
//
// Every row has a checksum, and the rows of each table are numbered without gaps, so damage is found when what it hit
// is read, and named. The first moment of every generation is there whole: whatever came after it is simulated again.
//
// Owner        one thread at a time: the storage thread while a server runs.
#pragma once

#include "server/base/executor.h"
#include "server/base/result.h"
#include "server/run_file/database.h"
#include "server/run_file/records.h"
#include "server/run_file/row.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace evod::run_file {

enum class Durability {
    Full,    // what has been committed is on the disk
    Relaxed, // what has been committed survives the program, but perhaps not the machine
};

class RunFile {
  public:
    static constexpr std::int64_t application_id = 0x45564f44; // "EVOD", at byte 68 of the file
    // 1 had no checkpoints; 2 no founders, and a fork did not know what had been before it; 3 no schedules, no accounts
    // of selection, and no checkpoints in parts.
    static constexpr std::int64_t format_version = 4;

    static constexpr int checkpoints_kept = 3;

    struct Options {
        Durability durability = Durability::Full;
        const char* vfs = nullptr;                           // as Database takes it
        std::int64_t file_bytes_max = std::int64_t{2} << 30; // see thin_if_large()
        // Of new files: only each of so many generations, counted from the file's first, is held for good; and the
        // last, while it is. A file keeps this to its end.
        std::uint64_t keep_every = 1;
        std::size_t part_bytes = 256 << 10; // of a checkpoint, at most; see write_part()
        std::uint32_t log_pages_max = 1000; // beyond this a log is copied into its file
    };

    /// A new file; refused if there is one. It is there whole, or not at all. Nobody else may be making it.
    ///
    /// beginning   of identity.first_generation; may follow later for a run that begins with generation 1.
    /// checkpoint  at identity.first_tick, for a run that begins within that generation; it is never taken out.
    /// inherited   identity.inherited_generations of them.
    static base::Result<std::unique_ptr<RunFile>> create(const std::string& path, const RunIdentity& identity,
                                                         const Options& options,
                                                         const GenerationBegun* beginning = nullptr,
                                                         const Checkpoint* checkpoint = nullptr,
                                                         const Inherited* inherited = nullptr);
    /// A new file under a name that is not its own yet; as after begin(). Until commit() it holds nothing.
    static base::Result<std::unique_ptr<RunFile>> begin_new(const std::string& path, const RunIdentity& identity,
                                                            const Options& options);
    /// What the write-ahead log held after the last commit.
    std::uint32_t log_pages() const { return database_.log_pages(); }
    /// As Database does. The other: of a file that is open here, for another thread to do.
    void copy_log() { database_.copy_log(); }
    static void copy_log(const std::string& path, const Options& options);
    /// Puts what has been committed into the file itself, which then needs no log beside it.
    base::Result<void> settle();
    /// Of a file from begin_new(): whether whoever was to make it did not come to the end of it.
    static base::Result<bool> holds_nothing(const std::string& path);
    /// To be gone on with: its end mark is taken away by the first commit. A file that holds nothing is damaged.
    static base::Result<std::unique_ptr<RunFile>> open(const std::string& path, const Options& options);
    /// Gives a file that is not open here another name, with all that SQLite keeps beside it: whoever is reading it
    /// goes on, and nothing of it is left under the old name.
    static base::Result<void> rename(const std::string& from, const std::string& to);
    /// Takes a file that nobody has open out of the world, with all that SQLite keeps beside it.
    static base::Result<void> remove(const std::string& path);
    /// To be looked at, while a server writes to it too.
    static base::Result<std::unique_ptr<RunFile>> open_read_only(const std::string& path);
    /// The same, unless its write-ahead log is damaged; not where this process has the file open already.
    static base::Result<std::unique_ptr<RunFile>> open_checked(const std::string& path);

    const std::string& path() const { return path_; }
    const RunIdentity& identity() const { return identity_; }
    /// Refused unless this program follows the model by which the run was made.
    std::optional<base::Refusal> other_model() const;

    // Reading. DATA_LOSS names the row that is not as it was written.

    /// From now on what is there now is read, whatever a server writes meanwhile.
    base::Result<void> hold_still();
    /// What hold_still() holds, as a file of its own, where there is none yet.
    base::Result<void> copy_to(const std::string& path);
    base::Result<std::optional<EndMark>> end_mark();
    /// The entries from number `first` on, at most `count`.
    base::Result<std::vector<JournalEntry>> journal(std::uint64_t first = 1, std::uint32_t count = ~0u);
    /// Number of the newest; 0 if there is none.
    std::uint64_t last_journal_entry();
    /// Of generations whose beginning is held; 0 if none is yet.
    std::uint64_t last_generation();
    /// The last that anything in the file tells of.
    std::uint64_t last_tick();
    /// The one in which the run was after that tick; the first if it had not begun.
    std::uint64_t generation_at(std::uint64_t tick);
    /// Nothing if the generation has not begun.
    base::Result<std::optional<simulation::Opening>> opening_of(std::uint64_t generation);
    /// Nothing if the generation's beginning is not held, or not any more.
    base::Result<std::optional<GenerationBegun>> beginning_of(std::uint64_t generation);
    /// Whether the hash after this tick, a multiple of ticks_per_link, is one that is held if it came to be written.
    bool is_link_held(std::uint64_t tick) const;
    /// The last generation up to this one whose beginning is held; itself if the run has not begun it.
    std::uint64_t held_at_or_before(std::uint64_t generation);
    /// The first from this generation on, which the run has begun.
    std::uint64_t held_at_or_after(std::uint64_t generation);
    /// See Options::keep_every.
    std::uint64_t keep_every() const { return keep_every_; }
    /// Nothing if the generation has not ended, or its outcome is not held any more.
    base::Result<std::optional<GenerationEnded>> outcome_of(std::uint64_t generation);
    /// One entry per island; nothing if the generation has not ended, or its statistics are not held.
    base::Result<std::vector<simulation::GenerationStatistics>> statistics_of(std::uint64_t generation);
    /// Of the last `count` generations before that one, oldest first; those that a fork inherited among them.
    base::Result<simulation::World::History> history(std::uint64_t before, std::size_t count);
    /// In order of ticks, those after `after` up to `until`.
    base::Result<std::vector<HashLink>> links(std::uint64_t after, std::uint64_t until);
    /// In order of ticks, those after `after` up to `until`.
    base::Result<std::vector<StoredCheckpoint>> checkpoints(std::uint64_t after, std::uint64_t until);
    /// The last of those up to a tick; nothing if there is none.
    base::Result<std::optional<StoredCheckpoint>> last_checkpoint(std::uint64_t until);
    /// What an end mark would say of what is there: its tick is the last that anything in the file tells of.
    EndMark contents();
    /// The newest that has ended; 0 if none has.
    std::uint64_t last_generation_ended();
    /// Whether SQLite finds the file sound, and every row is as it was written. Reads everything.
    ///
    /// told  called with each generation that is going to be read.
    base::Result<void> check(base::FunctionRef<void(std::uint64_t generation)> told);
    base::Result<void> check() {
        return check([](std::uint64_t) {});
    }
    /// Whether there is as much as the end mark says; all is well if there is none.
    base::Result<void> check_end_mark();

    // Writing. After something has gone wrong nothing more is written: commit() says what, and the file is to be opened
    // anew. What is written again takes the place of what was there.

    void begin();
    void write(const JournalEntry& entry);
    void write(const Inherited& inherited);
    void write(const GenerationBegun& begun);
    void write(const GenerationEnded& ended);
    void write(const HashLink& link);
    /// The newest checkpoints_kept stay, and the one with which the run begins. Nothing, where its generation is not
    /// held any more.
    void write(const StoredCheckpoint& checkpoint);
    void write(const Checkpoint& checkpoint);
    /// What the mark counts is counted here.
    void write(EndMark mark);
    /// Refused with the reason; then it is unknown whether what was written since begin() is there.
    base::Result<void> commit();

    /// The next part of a checkpoint, in a transaction of its own, so that a large one holds nobody up; not between
    /// begin() and commit(). It counts once its last part is there; one is written to its end before the next is begun.
    ///
    /// returns  whether there is no more to be written of it: it is there, or its generation is not held any more.
    base::Result<bool> write_part(const StoredCheckpoint& checkpoint);
    /// Takes out a little of what belongs to nothing, in a transaction of its own; not between begin() and commit().
    /// Not before something else has been committed: a file that is only opened stays as it is.
    ///
    /// returns  whether there was anything.
    base::Result<bool> tidy();

    /// If the file takes more than Options::file_bytes_max, half of the older generations' populations and outcomes,
    /// and half of the older hashes, are held no more, evenly; tidy() takes them out; again next time. The first
    /// generation, the last ones, the journal and all statistics stay, so a very long run may pass the bound all the
    /// same. Not between begin() and commit().
    base::Result<void> thin_if_large();
    /// Whether it takes more than that.
    bool is_large();

  private:
    struct Writers;
    using Accounts = std::vector<std::optional<evolution::SelectionAccount>>;
    /// A checkpoint whose last part is not there yet.
    struct HalfWritten {
        std::uint64_t tick = 0;
        std::vector<std::int64_t> checksums = {}; // of the parts that are
    };
    RunFile(const std::string& path, Database::Mode mode, const Options& options);
    void create_tables();
    void bring_up_to_date();
    void bring_up_to_format_3();
    void bring_up_to_format_4();
    void write_identity(const RunIdentity& identity);
    base::Result<void> read_identity();
    /// Whether the file has the tables of its format, and nothing else: no trigger, view or index that others made.
    base::Result<void> check_schema();
    base::Result<void> check_checkpoints(const EndMark& found);
    base::Result<std::vector<StoredCheckpoint>> checkpoints_where(const std::string& condition,
                                                                  const std::vector<std::int64_t>& where);
    base::Result<void> read_thinning();
    /// Whether SQLite finds a table and its indices sound; "1": the whole file, until the first fault.
    base::Result<void> check_tree(const std::string& of);
    base::Result<void> read_first_population();
    bool holds_nothing();
    bool is_held(std::uint64_t generation);
    bool has_checkpoint(std::uint64_t tick);
    /// Takes out a little of what thinning left.
    base::Result<void> sweep();
    /// All of a checkpoint's state but what is in its row.
    base::Result<std::string> parts_of(std::uint64_t tick, std::vector<std::int64_t>& checksums);
    /// Whether it was the last.
    bool write_next(const StoredCheckpoint& checkpoint, HalfWritten& half);
    /// The first tick after this one of which is_link_held().
    std::uint64_t next_link_held(std::uint64_t after) const;
    base::Result<std::vector<evolution::NextGeneration>> born_in(const simulation::Opening& opening);
    base::Result<simulation::Founders> founders_of(const GenerationBegun& begun);
    /// One per island; empty in a file of before there were accounts. Of a fork, also of generations that it inherited.
    base::Result<Accounts> accounts_of(std::uint64_t generation, std::size_t island_count);
    /// Adds the generations of a table of statistics that follow the last, or `first`, and come before `end`.
    base::Result<void> read_history(const char* table, std::uint64_t first, std::uint64_t end,
                                    simulation::World::History& history);
    base::Result<parameters::ParameterSet> parameter_set(std::int64_t number);
    std::int64_t number_of(const parameters::ParameterSet& parameters);
    /// What the database says has gone wrong, with the path.
    base::Refusal failure() const;
    base::Refusal damaged(const std::string& what) const;
    Writers& writers();

    std::string path_;
    Database database_;
    RunIdentity identity_;
    std::int64_t format_ = format_version; // of the file
    std::unique_ptr<Writers> writers_;
    std::optional<parameters::ParameterSet> last_parameters_; // written, under parameter_sets_
    std::int64_t parameter_sets_ = 0;
    std::optional<parameters::ParameterSet> read_parameters_; // last, under read_parameters_number_
    std::int64_t read_parameters_number_ = 0;
    bool marked_ = false; // there may be an end mark
    Thinning thinning_;
    std::uint64_t keep_every_ = 1;
    std::optional<HalfWritten> half_written_;
    bool tidy_ = false; // no part is left that belongs to no checkpoint
    /// What thinning left to be taken out: nothing up to this generation, nor then of hashes up to this tick.
    struct Sweep {
        std::uint64_t generation, tick;
    };
    std::optional<Sweep> sweep_;
    const Options options_;

  public:
    ~RunFile();
};

} // namespace evod::run_file
