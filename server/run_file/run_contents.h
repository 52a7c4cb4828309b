// Run contents: read access to the tables of an open run file.
//
// Errors       DATA_LOSS names the row whose contents differ from what was written.
// Owner        a RunFile, which also opens the file and writes to it.
#pragma once

#include "server/base/result.h"
#include "server/run_file/checkpoints.h"
#include "server/run_file/generations.h"
#include "server/run_file/identity.h"
#include "server/run_file/journal.h"
#include "server/run_file/parameter_sets.h"
#include "server/run_file/records.h"
#include "server/run_file/retention.h"
#include "server/run_file/run_database.h"

#include <optional>
#include <string>
#include <vector>

namespace evod::run_file {

class RunContents {
  public:
    const std::string& path() const { return database_.path; }
    const RunIdentity& identity() const { return identity_.run; }
    /// Returns a refusal if the run has a model version other than that of this program.
    std::optional<base::Refusal> other_model() const;

    Journal& journal() { return journal_; }
    Generations& generations() { return generations_; }
    Checkpoints& checkpoints() { return checkpoints_; }
    Retention& retention() { return retention_; }
    const Retention& retention() const { return retention_; }
    /// Reads the retained state hashes after tick `after`, up to and including tick `until`, in order of ticks.
    base::Result<std::vector<HashRecord>> hashes(std::uint64_t after, std::uint64_t until);
    /// The end mark; nullopt while a server has the file open, or after a server was killed.
    base::Result<std::optional<EndMark>> end_mark();
    /// The end mark that would describe the present rows.
    EndMark contents();
    /// The latest tick in any row.
    std::uint64_t last_tick();

    RunDatabase& database() { return database_; }
    base::Refusal damaged(const std::string& what) const { return database_.damaged(what); }

  protected:
    RunContents(const std::string& path, Database::Mode mode, const char* vfs, std::size_t part_bytes)
        : database_{path, mode, vfs}, checkpoints_{database_, identity_.run, parameter_sets_, retention_, part_bytes} {}
    ~RunContents() = default;

    RunDatabase database_;
    StoredIdentity identity_;
    ParameterSets parameter_sets_{database_};
    Journal journal_{database_};
    Retention retention_{database_, identity_.run, identity_.keep_every};
    Generations generations_{database_, identity_.run, parameter_sets_, retention_};
    Checkpoints checkpoints_;
};

} // namespace evod::run_file
