// Retention: decides which generations of a run file are stored whole, and deletes the data of all other generations.
//
// A new file retains every keep_every-th generation, counted from its first one. It also retains the newest generation
// until the next one begins. If a file exceeds its size limit, half of its older generations and state hashes are
// deleted, evenly spaced. The same happens whenever the file reaches the limit again. The first generation, the newest
// generations, the journal and all statistics stay.
//
// A rule takes effect when its transaction is committed. From then on, readers ignore the rows that the rule excludes.
// purge_step() deletes these rows later, in small transactions.
//
// Owner        a RunFile.
#pragma once

#include "server/run_file/records.h"
#include "server/run_file/run_database.h"

#include <optional>

namespace evod::run_file {

class Retention {
  public:
    /// identity, keep_every  values of this file. This object stores references, so they may be set later.
    Retention(RunDatabase& database, const RunIdentity& identity, const std::uint64_t& keep_every)
        : database_{database}, identity_{identity}, keep_every_{keep_every} {}

    /// Reads the rule that is in effect.
    base::Result<void> read();

    /// A new file retains every keep_every-th generation. The value never changes during the life of a file.
    std::uint64_t keep_every() const { return keep_every_; }
    bool is_retained(std::uint64_t generation);
    /// Returns the last retained generation up to `generation`; `generation` itself if the run has not begun it.
    std::uint64_t at_or_before(std::uint64_t generation);
    /// Returns the first retained generation from `generation` on. The run must have begun `generation`.
    std::uint64_t at_or_after(std::uint64_t generation);
    /// Whether the state hash after this tick is retained. The tick must be a multiple of ticks_per_hash.
    bool is_hash_retained(std::uint64_t tick) const;
    /// The first tick after `tick` with a retained state hash.
    std::uint64_t next_hash_after(std::uint64_t tick) const;

    /// Whether the rows of the file occupy more than this number of bytes. Returns false during a purge.
    bool exceeds(std::int64_t bytes);
    /// Reduces the number of retained older generations by half, in its own transaction, and begins a purge.
    ///
    /// returns  false if nothing is left to halve.
    base::Result<bool> halve();
    /// Begins a purge again, because an earlier one may be incomplete. Must be called after a file has been opened.
    void resume_purge();
    bool is_purging() const { return purge_.has_value(); }
    /// Deletes one batch in its own transaction. Deletes nothing when the purge is complete.
    base::Result<void> purge_step();

  private:
    /// Progress of a purge: generations are purged up to `generation`, state hashes up to `tick`.
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
