// Checkpoints: the tables `checkpoint` and `checkpoint_part` of a run file.
//
// A large state is written in parts, each in a transaction of its own, so that commands need not wait for all of it.
// The row of `checkpoint` comes last: parts without such a row belong to a checkpoint that was not completed or has been
// deleted. They are orphans, which readers ignore and delete_orphans() removes.
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
    /// How many of the newest stay, beside the one with which the run begins.
    static constexpr int retained_count = 3;

    /// part_bytes  at most so many in a part. Everything passed in outlives this.
    Checkpoints(RunDatabase& database, const RunIdentity& identity, ParameterSets& parameter_sets, Retention& retention,
                std::size_t part_bytes)
        : database_{database}
        , identity_{identity}
        , parameter_sets_{parameter_sets}
        , retention_{retention}
        , part_bytes_{part_bytes} {}

    /// Those after tick `after` up to tick `until`, in order of ticks.
    base::Result<std::vector<StoredCheckpoint>> read(std::uint64_t after, std::uint64_t until);
    /// The last one up to a tick; nothing if there is none.
    base::Result<std::optional<StoredCheckpoint>> last(std::uint64_t until);
    /// The first one after a tick, which may be −1; nothing if there is none.
    base::Result<std::optional<StoredCheckpoint>> next(std::int64_t after);

    /// Writes a whole checkpoint within the current transaction; does nothing if its generation is not retained.
    void write(const StoredCheckpoint& checkpoint);
    void write(const Checkpoint& checkpoint);

    /// Whether nothing of the checkpoint is left to be written: it is in the file, or its generation is not retained.
    bool is_written(const StoredCheckpoint& checkpoint);
    /// Writes the next part within the current transaction; all parts of one checkpoint come before another's first.
    ///
    /// returns  whether it was the last.
    bool write_part(const StoredCheckpoint& checkpoint);
    /// The part is committed.
    void part_written(bool was_last);

    /// Rows of `checkpoint` have been deleted elsewhere.
    void expect_orphans() { may_have_orphans_ = true; }
    bool may_have_orphans() const { return may_have_orphans_; }
    /// Whether there is an orphan, other than parts of a checkpoint that is being written.
    bool has_orphans();
    /// Deletes some orphans within the current transaction.
    void delete_some_orphans();
    /// Deletes all of them, those of a checkpoint that is being written included.
    void delete_all_orphans();

  private:
    /// A checkpoint whose last part has not been written.
    struct Unfinished {
        std::uint64_t tick = 0;
        std::vector<std::int64_t> checksums = {}; // of the parts that have been
    };
    base::Result<std::vector<StoredCheckpoint>> read_where(const std::string& condition,
                                                           const std::vector<std::int64_t>& values);
    /// Appends all parts of a state but the last, which is in the row of its checkpoint.
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
