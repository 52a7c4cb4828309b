// Stored run: finds a moment in the file of a run, and the stored state from which the moment can be simulated.
//
// The file is opened again for each use, also if it has been renamed because the run ended. So the run may be
// continued, reset or purged between two uses.
//
// Threads      no threads of its own. Each thread uses its own copy of this object.
#pragma once

#include "server/replay/rerun.h"
#include "server/simulation/laboratory.h"

#include <optional>
#include <string>
#include <vector>

namespace evod::replay {

/// A requested moment. If both fields are empty, it is the last known moment.
struct WantedMoment {
    std::optional<std::uint64_t> generation;
    std::optional<std::uint64_t> tick; // tick of the generation, or of the run if no generation is given
};

/// A moment of the run. The last tick of a generation and the beginning of the next generation are different moments.
struct SeekTarget {
    std::uint64_t generation = 1;
    std::uint64_t tick = 0; // ticks since the run began
};

/// A moment, and the stored state from which the simulation of that moment starts.
struct SeekStart {
    simulation::Replay there; // the moments of the run; replay_of is empty
    SeekTarget to;
    Rerun from; // at the last stored state at or before the moment
};

/// The moment up to which a live run has been passed to the storage thread. When this data has been written, the file
/// reaches this moment or a later one. If both are 0, only the contents of the file are known.
struct RecordedUntil {
    std::uint64_t generation = 0, tick = 0;
};

/// The records that a live run has added since they were last read.
struct NewRecords {
    simulation::Replay there; // replay_of is empty
    std::string path;         // path of the run's file
    // Range of the journal entries in `changes`: from after_entry + 1 to last_entry.
    std::uint64_t after_entry = 0, last_entry = 0;
    std::vector<WorldChange> changes;
};

class StoredRun {
  public:
    /// A replay has the statistics of at most this number of generations before its first moment.
    static constexpr std::size_t history_generations_known = 1'000;

    /// paths  the paths of the run's file: the present path, and the path after the run has ended.
    StoredRun(std::vector<std::string> paths, const simulation::RunId& run_id)
        : paths_{std::move(paths)}, run_id_{run_id} {}
    /// Opens the run in a file. Refused if the file does not exist, or if the run cannot be simulated again.
    static base::Result<StoredRun> of_file(const std::string& path);

    const simulation::RunId& run_id() const { return run_id_; }
    /// The name of the run's world, read from the file.
    base::Result<std::string> world_name() const;

    /// Finds a moment and the stored state to start from. Refused if the run does not contain the moment; the message
    /// then contains the allowed range.
    ///
    /// wanted  nullopt: the first moment.
    /// known   must be determined before the caller waits for the disk. The file then contains every command up to this
    ///         moment, and the beginning of its generation.
    /// stop    stops reading, which is then refused with UNAVAILABLE.
    base::Result<SeekStart> start_seek(const std::optional<WantedMoment>& wanted, RecordedUntil known,
                                       base::Executor& executor, const base::StopCheck& stop = {}) const;

    /// after_entry  the journal entries up to and including this one are skipped.
    base::Result<NewRecords> new_records(std::uint64_t after_entry, const base::StopCheck& stop = {}) const;

    /// Opens the file of the run for reading, under its present name.
    base::Result<std::unique_ptr<run_file::RunFile>> open() const;

  private:
    std::vector<std::string> paths_;
    simulation::RunId run_id_;
};

} // namespace evod::replay
