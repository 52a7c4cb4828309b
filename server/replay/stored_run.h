// Stored run: the file of a run as replays use it: which moments it contains, and from where each can be simulated.
//
// The file is opened for each use, and found under the name of an ended run too. So the run may continue, be reset or be
// purged meanwhile.
//
// Threads      none of its own; any thread uses a copy of its own.
#pragma once

#include "server/replay/rerun.h"
#include "server/simulation/laboratory.h"

#include <optional>
#include <string>
#include <vector>

namespace evod::replay {

/// A requested moment. Without both fields: the last known one.
struct WantedMoment {
    std::optional<std::uint64_t> generation;
    std::optional<std::uint64_t> tick; // of the generation; of the run if no generation is given
};

/// An existing moment. The last tick of a generation and the beginning of the next are different moments.
struct SeekTarget {
    std::uint64_t generation = 1;
    std::uint64_t tick = 0; // since the run began
};

/// A moment and the stored state from which it is simulated.
struct SeekStart {
    simulation::Replay there; // the moments of the run; replay_of is empty
    SeekTarget to;
    Rerun from; // the last stored state up to that moment
};

/// The moment up to which a live run has been handed over to the storage thread. Once that is written, the file reaches as
/// far or further. Zeros: only the file's contents are known.
struct RecordedUntil {
    std::uint64_t generation = 0, tick = 0;
};

/// The records that a live run has written since an earlier reading.
struct NewRecords {
    simulation::Replay there;                      // replay_of is empty
    std::string path;                              // of its file
    std::uint64_t after_entry = 0, last_entry = 0; // of the journal: the changes after the first up to the second
    std::vector<ParameterChange> changes;
};

class StoredRun {
  public:
    /// A replay has the statistics of at most so many generations before its first moment.
    static constexpr std::size_t history_generations_known = 1'000;

    /// paths  of the run's file, now and after its end.
    StoredRun(std::vector<std::string> paths, const simulation::RunId& run_id)
        : paths_{std::move(paths)}, run_id_{run_id} {}
    /// The run of a file. Refused if there is no file, or it cannot be simulated again.
    static base::Result<StoredRun> of_file(const std::string& path);

    const simulation::RunId& run_id() const { return run_id_; }
    /// The name of the run's world, from the file.
    base::Result<std::string> world_name() const;

    /// Refused if the run has no such moment; the message contains the allowed range.
    ///
    /// wanted  nothing: the first.
    /// known   taken before the caller waited for the disk, so that the file contains every command until then and the
    ///         beginning of that generation.
    base::Result<SeekStart> start_seek(const std::optional<WantedMoment>& wanted, RecordedUntil known,
                                       base::Executor& executor) const;

    /// after_entry  the journal's entries up to this one are skipped.
    base::Result<NewRecords> new_records(std::uint64_t after_entry) const;

    /// Opens its file for reading, wherever it is now.
    base::Result<std::unique_ptr<run_file::RunFile>> open() const;

  private:
    std::vector<std::string> paths_;
    simulation::RunId run_id_;
};

} // namespace evod::replay
