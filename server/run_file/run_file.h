// Run file: one world's run as an SQLite database, `NAME.evod`. Tables and columns: docs/RUN_FILE.md.
//
// Every row has a checksum, and the rows of each table are numbered without gaps. So a reader finds damage in what it
// reads, and names it. The beginning of every retained generation is stored whole; everything after it is simulated
// again (replay/).
//
//   run_contents                                      the tables: journal · generations · checkpoints · retention
//   schema · identity                                 what a file must have before anything else is read
//   check                                             reads and checks everything
//
// Owner        one thread at a time: the storage thread while a server runs.
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
    Full,    // what has been committed is on the disk
    Relaxed, // what has been committed survives the program, but perhaps not the machine
};

class RunFile : public RunContents {
  public:
    struct Options {
        Durability durability = Durability::Full;
        const char* vfs = nullptr;                           // of SQLite, as Database takes it
        std::int64_t file_bytes_max = std::int64_t{2} << 30; // see shrink_if_large()
        std::uint64_t keep_every = 1;                        // of new files: see Retention
        std::size_t part_bytes = 256 << 10;                  // of a checkpoint, at most: see write_checkpoint_part()
        std::uint32_t log_pages_max = 1000;                  // a longer log is copied into its file
    };
    using Record = std::variant<JournalEntry, Inherited, GenerationBegun, GenerationEnded, HashRecord, Checkpoint,
                                StoredCheckpoint, EndMark>;

    /// Creates a file with these first records; refused if there is one. After a failure there is no file of that name.
    static base::Result<std::unique_ptr<RunFile>> create(const std::string& path, const RunIdentity& identity,
                                                         const Options& options, const std::vector<Record>& first = {});
    /// Creates a file in an open transaction, as after begin(). Until commit() the file is empty.
    static base::Result<std::unique_ptr<RunFile>> begin_new(const std::string& path, const RunIdentity& identity,
                                                            const Options& options);
    /// Opens a file to continue its run. The first commit deletes the end mark.
    static base::Result<std::unique_ptr<RunFile>> open(const std::string& path, const Options& options);
    /// Opens a file to read it; a server may write to it meanwhile.
    static base::Result<std::unique_ptr<RunFile>> open_read_only(const std::string& path);
    /// The same, but refused if its write-ahead log is damaged. Not for a file that this process has open already.
    static base::Result<std::unique_ptr<RunFile>> open_checked(const std::string& path);

    // Reading: RunContents.

    /// Reads from now on what the file contains now, whatever a server writes meanwhile.
    base::Result<void> pin_snapshot();
    /// Copies the pinned snapshot to a new file.
    base::Result<void> copy_to(const std::string& path);

    // Writing. After an error nothing more is written: commit() reports it, and the caller opens the file again. A row
    // that is written again replaces the row with the same key.

    void begin();
    /// The end mark's numbers of rows are counted here; its other fields are those of the record.
    void write(const Record& record);
    /// Refused with the reason; then it is not known whether the records since begin() are in the file.
    base::Result<void> commit();
    /// Writes the next part of a checkpoint in a transaction of its own; not between begin() and commit().
    ///
    /// returns  whether nothing of it is left to be written.
    base::Result<bool> write_checkpoint_part(const StoredCheckpoint& checkpoint);
    /// Deletes one batch of orphaned checkpoint parts and of what is not retained, in a transaction of its own; not
    /// between begin() and commit(). A file that has only been opened stays unchanged.
    ///
    /// returns  whether there was anything to delete, or may be more.
    base::Result<bool> purge_step();
    /// Reduces the retention if the file exceeds Options::file_bytes_max; not between begin() and commit(). The file may
    /// exceed it all the same, because the journal and all statistics stay.
    base::Result<void> shrink_if_large();
    bool is_large() { return retention_.exceeds(options_.file_bytes_max); }
    /// Moves everything committed from the log into the file.
    base::Result<void> merge_log();

  private:
    RunFile(const std::string& path, Database::Mode mode, const Options& options);
    base::Result<void> read_beginning();
    void put(EndMark mark);

    const Options options_;
    std::optional<TableWriter<StateHashTable>> hash_writer_;
};

/// Whether a file from RunFile::begin_new() is still empty: it was not committed.
base::Result<bool> is_empty_file(const std::string& path);

/// Copies the log of a file that another thread has open into the file.
void copy_log(const std::string& path, const RunFile::Options& options);

} // namespace evod::run_file
