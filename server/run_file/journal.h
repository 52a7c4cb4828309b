// Journal: the table `journal` of a run file. It contains the commands of a run in the order in which they were
// applied.
//
// Owner        a RunFile.
#pragma once

#include "server/run_file/records.h"
#include "server/run_file/rows.h"
#include "server/run_file/run_database.h"

#include <optional>
#include <vector>

namespace evod::run_file {

class Journal {
  public:
    explicit Journal(RunDatabase& database) : database_{database} {}

    /// Reads entries from number `first` on. Stops after `count` entries, or after the entry with which their sum
    /// exceeds `bytes_max` bytes. DATA_LOSS names a damaged or missing entry.
    /// If `first` is 1, SQLite checks the whole table beforehand, because no other row shows that the last entries are
    /// missing.
    base::Result<std::vector<JournalEntry>> read(std::uint64_t first = 1, std::uint32_t count = ~0u,
                                                 std::size_t bytes_max = ~std::size_t{0});
    /// Number of the newest entry; 0 if there is none.
    std::uint64_t last_number() { return database_.natural("SELECT max(number) FROM journal"); }
    /// The client keys of the commands up to entry number `last`, in the order of their last use. Beyond `keys_max`,
    /// the keys that were not used for the longest time are left out. Reads the index journal_key, so the time is that
    /// of reading some 30 bytes per entry. The checksums of the entries are not compared.
    base::Result<std::vector<UsedKey>> used_keys(std::uint64_t last, std::size_t keys_max);
    void write(const JournalEntry& entry);

  private:
    RunDatabase& database_;
    std::optional<TableWriter<JournalTable>> writer_;
};

} // namespace evod::run_file
