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

    /// Reads at most `count` entries, beginning with entry number `first`. DATA_LOSS names a damaged or missing entry.
    /// If `first` is 1, SQLite checks the whole table beforehand, because no other row shows that the last entries are
    /// missing.
    base::Result<std::vector<JournalEntry>> read(std::uint64_t first = 1, std::uint32_t count = ~0u);
    /// Number of the newest entry; 0 if there is none.
    std::uint64_t last_number() { return database_.natural("SELECT max(number) FROM journal"); }
    void write(const JournalEntry& entry);

  private:
    RunDatabase& database_;
    std::optional<TableWriter<JournalTable>> writer_;
};

} // namespace evod::run_file
