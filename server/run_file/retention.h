// Retention: which generations of a run file are stored whole, and deleting the others.
//
// A new file keeps each keep_every-th generation, counted from its first, and the last one while it is the last. A file
// that exceeds its size limit loses half of its older generations and state hashes, evenly, and again when it is as
// large again. The first generation, the last ones, the journal and all statistics stay.
//
// A rule takes effect with its commit; from then on what it excludes is not read. purge_step() deletes it later, in
// small transactions.
//
// Owner        a RunFile.
#pragma once

#include "server/run_file/records.h"
#include "server/run_file/run_database.h"

#include <optional>

namespace evod::run_file {

class Retention {
  public:
    /// identity, keep_every  of the file; both may be read from it later.
    Retention(RunDatabase& database, const RunIdentity& identity, const std::uint64_t& keep_every)
        : database_{database}, identity_{identity}, keep_every_{keep_every} {}

    /// Reads the rule that holds now.
    base::Result<void> read();

    /// Each of how many generations a new file keeps; does not change during the life of a file.
    std::uint64_t keep_every() const { return keep_every_; }
    bool is_retained(std::uint64_t generation);
    /// The last retained generation up to this one; itself if the run has not begun it.
    std::uint64_t at_or_before(std::uint64_t generation);
    /// The first retained generation from this one on; the run has begun this one.
    std::uint64_t at_or_after(std::uint64_t generation);
    /// Whether the state hash after this tick, a multiple of ticks_per_hash, is retained.
    bool is_hash_retained(std::uint64_t tick) const;
    /// The first tick after this one whose state hash is retained.
    std::uint64_t next_hash_after(std::uint64_t tick) const;

    /// Whether the rows of the file take more bytes than this. false while a purge is under way.
    bool exceeds(std::int64_t bytes);
    /// The rule that halves what is retained of the older generations; nothing if there is nothing left to halve.
    std::optional<RetentionRule> next_rule();
    /// Writes a rule within the current transaction.
    void write(const RetentionRule& next);
    /// The rule is committed: it holds from now on, and a purge begins.
    void begin_purge(const RetentionRule& committed);
    /// After a file has been opened: an earlier purge may be incomplete.
    void resume_purge();
    bool is_purging() const { return purge_.has_value(); }
    /// Deletes one batch, in a transaction of its own; at the end of the purge nothing.
    base::Result<void> purge_step();

  private:
    /// Up to this generation, then up to this tick for hashes, the purge is complete.
    struct Purge {
        std::uint64_t generation = 0, tick = 0;
    };
    std::uint64_t last_generation();
    base::Result<void> purge_generations();

    RunDatabase& database_;
    const RunIdentity& identity_;
    const std::uint64_t& keep_every_;
    RetentionRule rule_;
    std::optional<Purge> purge_;
};

} // namespace evod::run_file
