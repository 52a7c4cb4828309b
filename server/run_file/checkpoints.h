// Checkpoints: the tables `checkpoint` and `checkpoint_part` of a run file.
//
// A large state is written in parts, each in its own transaction, so that commands do not wait until the whole state is
// written. The row of `checkpoint` is written last. Parts without such a row are orphans: their checkpoint was not
// completed or has been deleted. Readers ignore orphans; delete_some_orphans() and delete_all_orphans() delete them.
//
// Owner        a RunFile.
#pragma once

#include "server/run_file/parameter_sets.h"
#include "server/run_file/records.h"
#include "server/run_file/retention.h"
#include "server/run_file/run_database.h"

#include <optional>
#include <string>
#include <vector>

namespace evod::run_file {

class Checkpoints {
  public:
    /// Number of newest checkpoints that are retained, in addition to the checkpoint with which the run begins.
    static constexpr int retained_count = 3;

    /// part_bytes  maximum size of one part. All references that are passed in must outlive this object.
    Checkpoints(RunDatabase& database, const RunIdentity& identity, ParameterSets& parameter_sets, Retention& retention,
                std::size_t part_bytes)
        : database_{database}
        , identity_{identity}
        , parameter_sets_{parameter_sets}
        , retention_{retention}
        , part_bytes_{part_bytes} {}

    /// Reads the checkpoints after tick `after`, up to and including tick `until`, in order of ticks.
    base::Result<std::vector<StoredCheckpoint>> read(std::int64_t after, std::uint64_t until);
    /// The last checkpoint at or before tick `until`; nullopt if there is none.
    base::Result<std::optional<StoredCheckpoint>> last(std::uint64_t until);
    /// The first checkpoint after tick `after`, which may be −1; nullopt if there is none.
    base::Result<std::optional<StoredCheckpoint>> next(std::int64_t after);

    /// Writes a whole checkpoint within the current transaction. Does nothing if its generation is not retained.
    void write(const StoredCheckpoint& checkpoint);
    void write(const Checkpoint& checkpoint);

    /// Whether the checkpoint needs no further writing: it is in the file, or its generation is not retained.
    bool is_written(const StoredCheckpoint& checkpoint);
    /// Writes the next part of a checkpoint within the current transaction. All parts of one checkpoint must be written
    /// before the first part of another.
    ///
    /// returns  whether this was the last part.
    bool write_part(const StoredCheckpoint& checkpoint);
    /// Must be called after the transaction with a part has been committed.
    void part_written(bool was_last);

    /// Must be called after other code has deleted rows of `checkpoint`.
    void expect_orphans() { may_have_orphans_ = true; }
    bool may_have_orphans() const { return may_have_orphans_; }
    /// Whether the file contains orphans. Parts of a checkpoint that is being written do not count.
    bool has_orphans();
    /// Deletes one batch of orphans within the current transaction.
    void delete_some_orphans();
    /// Deletes all orphans within the current transaction, and all parts of a checkpoint that is being written.
    void delete_all_orphans();

  private:
    /// A checkpoint whose last part has not been written.
    struct Unfinished {
        std::uint64_t tick = 0;
        std::vector<std::int64_t> checksums = {}; // checksums of the parts written so far
    };
    base::Result<std::vector<StoredCheckpoint>> read_where(const std::string& condition,
                                                           const std::vector<std::int64_t>& values);
    /// Appends the parts of a state to `state`. The last part is in the row of the checkpoint and is not read here.
    base::Result<void> read_parts(std::uint64_t tick, std::string& state, std::vector<std::int64_t>& checksums);
    bool write_next(const StoredCheckpoint& checkpoint, Unfinished& unfinished);
    std::string orphans_condition() const;

    RunDatabase& database_;
    const RunIdentity& identity_;
    ParameterSets& parameter_sets_;
    Retention& retention_;
    const std::size_t part_bytes_;
    std::optional<Unfinished> unfinished_;
    bool may_have_orphans_ = true;
};

} // namespace evod::run_file
