// Run file: the run of one world, stored as an SQLite database, `NAME.evod`. Tables and columns: docs/RUN_FILE.md.
//
// Every row has a checksum, and the rows of each table are numbered without gaps. So a reader detects damage in the
// rows that it reads, and names the damaged row. The beginning of every retained generation is stored whole; everything
// after it can be simulated again (replay/).
//
//   run_contents                                      the tables: journal · generations · checkpoints · retention
//   schema · identity                                 checked before anything else in a file is read
//   check                                             reads the whole file and checks every row
//
// Owner        one thread at a time. While a server runs, it is the storage thread.
#pragma once

#include "server/base/result.h"
#include "server/run_file/records.h"
#include "server/run_file/rows.h"
#include "server/run_file/run_contents.h"

#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace evod::run_file {

enum class Durability {
    Full,    // every commit is on the disk
    Relaxed, // a commit survives a crash of the program, but possibly not of the machine
};

class RunFile : public RunContents {
  public:
    struct Options {
        Durability durability = Durability::Full;
        const char* vfs = nullptr;                           // name of an SQLite VFS, as for Database
        std::int64_t file_bytes_max = std::int64_t{2} << 30; // see shrink_if_large()
        std::uint64_t keep_every = 1;                        // for new files: see Retention
        // Maximum size of a checkpoint part: see write_checkpoint_part().
        std::size_t part_bytes = 256 << 10;
        std::uint32_t log_pages_max = 1000; // a log with more pages is copied into its file
    };
    /// As Options::file_bytes_max, of the worlds of a class.
    static constexpr std::int64_t class_file_bytes_max = std::int64_t{32} << 20;
    using Record = std::variant<JournalEntry, Inherited, GenerationBegun, GenerationEnded, HashRecord, Checkpoint,
                                StoredCheckpoint, EndMark>;

    /// Creates a file with these first records. Refused if the file exists. After a failure, no file has that name.
    static base::Result<std::unique_ptr<RunFile>> create(const std::string& path, const RunIdentity& identity,
                                                         const Options& options, const std::vector<Record>& first = {});
    /// The records with which the file of a run begins, after its identity.
    static std::vector<Record> records_of(RunBeginning beginning);
    /// Creates a file and begins its first transaction, as begin() does. The file is empty until commit().
    static base::Result<std::unique_ptr<RunFile>> begin_new(const std::string& path, const RunIdentity& identity,
                                                            const Options& options);
    /// Opens a file to continue its run. The first commit deletes the end mark.
    static base::Result<std::unique_ptr<RunFile>> open(const std::string& path, const Options& options);
    /// Opens a file for reading. A server may write to the file at the same time.
    static base::Result<std::unique_ptr<RunFile>> open_read_only(const std::string& path);
    /// Like open_read_only(), but refused if the write-ahead log is damaged. This process must not have the file open
    /// already.
    static base::Result<std::unique_ptr<RunFile>> open_checked(const std::string& path);

    // RunContents declares the functions for reading.

    /// Makes this object read only the current contents of the file, even if a server writes to it later.
    base::Result<void> pin_snapshot();
    /// Copies the pinned snapshot to a new or empty file. If `stop` stops the work, the copy is not complete.
    base::Result<void> copy_to(const std::string& path, const base::StopCheck& stop = {});

    // Writing. After an error, nothing more is written: commit() reports the error, and the caller must open the file
    // again. A row replaces an existing row with the same key.

    void begin();
    /// Writes a record. If it is an end mark, this function counts the rows of the file and ignores the counts in the
    /// record.
    void write(const Record& record);
    /// Replaces the parameter generation_limit of the run, as if it had begun with this limit. Only between begin() and
    /// commit(), and only for a run that is not a fork, has no schedule for this parameter, and had no commands.
    base::Result<void> set_generation_limit(std::uint32_t limit);
    /// Commits the transaction that begin() has started. After a refusal, it is unknown whether the file contains the
    /// records since begin().
    base::Result<void> commit();
    /// Writes the next part of a checkpoint in its own transaction. Not allowed between begin() and commit().
    ///
    /// returns  whether the checkpoint needs no further writing.
    base::Result<bool> write_checkpoint_part(const StoredCheckpoint& checkpoint);
    /// Deletes one batch of orphaned checkpoint parts and of rows that are not retained, in its own transaction. Not
    /// allowed between begin() and commit(). Does not change a file that has only been opened.
    ///
    /// returns  false if there was nothing to delete; true if there may be more.
    base::Result<bool> purge_step();
    /// Reduces the retention if the file exceeds Options::file_bytes_max. Not allowed between begin() and commit(). The
    /// file may still exceed the limit afterwards, because the journal and all statistics stay.
    base::Result<void> shrink_if_large();
    bool is_large() { return retention_.exceeds(file_bytes_max()); }
    /// Whether the run of a world of a class has so much data that is always retained that it must not go on.
    bool is_full() { return is_of_class() && retention_.exceeds(2 * class_file_bytes_max); }
    /// Whether the world of the run belongs to a class.
    bool is_of_class() const { return !identity().ownership.class_name.empty(); }
    /// Copies all committed pages from the log into the file.
    base::Result<void> merge_log();

  private:
    RunFile(const std::string& path, Database::Mode mode, const Options& options);
    base::Result<void> read_beginning();
    void put(EndMark mark);

    std::int64_t file_bytes_max() const {
        return is_of_class() ? std::min(options_.file_bytes_max, class_file_bytes_max) : options_.file_bytes_max;
    }

    const Options options_;
    std::optional<TableWriter<StateHashTable>> hash_writer_;
};

/// Whether a file from RunFile::begin_new() is still empty because its first transaction was not committed.
base::Result<bool> is_empty_file(const std::string& path);

/// Copies the write-ahead log of a file into the file, while another thread has the file open.
void copy_log(const std::string& path, const RunFile::Options& options);

} // namespace evod::run_file
