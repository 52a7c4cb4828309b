// Run recording: writes the run file of a run without a server, and continues a run that was interrupted.
//
// One transaction contains the results of a generation, the beginning of the next one and its first tick. So a run that
// was killed at any moment continues at the beginning of the generation that it was simulating, and loses only the
// ticks of that generation. The file contains everything that a server would record, except checkpoints.
//
// Owner        the thread that advances the world.
// Threads      only the owner.
// Determinism  it reads the world and never changes it. A continued run has the same bits as an uninterrupted one; all
//              state hashes that are stored after the moment at which it continues are compared.
#pragma once

#include "server/parameters/experiment.h"
#include "server/recording/recorder.h"
#include "server/run_file/run_file.h"
#include "server/run_file/run_file_lock.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace evod::experiments {

/// How much of a run its file contains.
enum class Stored : std::uint8_t { Nothing, Part, Whole };

class RunRecording {
  public:
    /// Opens the run file of a run; it need not exist. A refusal leaves the file unchanged. Refused if the file is no
    /// run file, is damaged, is being written, or contains another run than that of this experiment. A run with
    /// a higher generation_limit continues a stored run that is otherwise the same.
    ///
    /// experiment        if it has no seed, the file may have any.
    /// first_population  may have fewer organisms than the world has places; the file then begins with these.
    static base::Result<std::unique_ptr<RunRecording>> open(std::string path, const parameters::Experiment& experiment,
                                                            const simulation::FirstPopulation& first_population);

    const std::string& path() const { return path_; }
    Stored stored() const { return stored_; }
    /// The seed of the stored run; nullopt if nothing is stored.
    std::optional<base::Seed> seed() const;
    /// The first population of the stored run, with all its places filled. Only if something is stored.
    const simulation::FirstPopulation& first_population() const { return first_population_; }
    /// The generation at whose beginning a run continues. Only if a part of it is stored.
    std::uint64_t continues_at() const { return begun_.opening.moment.generation; }
    /// The world at the beginning of that generation; called once. Its history is empty.
    ///
    /// maker  as for a new world. The number of processes may differ from that of the interrupted run.
    simulation::World continued_world(const parameters::Experiment& experiment,
                                      simulation::FirstPopulation first_population, base::Executor& executor,
                                      simulation::IslandsMaker* maker);
    /// Calls use(statistics) for every island of every stored generation before the one at which the run continues; of
    /// a whole run, for all generations.
    base::Result<void>
    read_statistics(const std::function<void(const std::vector<simulation::GenerationStatistics>&)>& use);

    /// Begins to write. Creates the file if it does not exist.
    ///
    /// world   at its first moment, or as continued_world() has returned it.
    /// run_id  for a new file.
    base::Result<void> begin(const simulation::World& world, const simulation::RunId& run_id);
    /// Adds the new records of the world to the transaction. To be called after every multiple of
    /// run_file::ticks_per_hash, and after the first and the last tick of every generation.
    ///
    /// returns  a refusal if the state differs from that of the interrupted run.
    base::Result<void> follow(const simulation::World& world);
    /// Makes everything durable that follow() has added.
    base::Result<void> commit();
    /// Closes the file after the last call of the others.
    base::Result<void> close(const simulation::World& world);

  private:
    explicit RunRecording(std::string path) : path_{std::move(path)} {}
    /// Finds out what the file contains.
    base::Result<void> examine(const parameters::Experiment& experiment,
                               const simulation::FirstPopulation& first_population);
    base::Result<void> read_part(run_file::RunFile& file, const parameters::Experiment& experiment);
    base::Result<void> create(const simulation::RunId& run_id, const run_file::GenerationBegun& begun,
                              const simulation::World& world);

    const std::string path_;
    std::optional<run_file::RunFileLock> lock_;
    std::unique_ptr<run_file::RunFile> file_; // nullptr before begin() and after close()
    Stored stored_ = Stored::Nothing;
    std::optional<std::uint32_t> longer_limit_; // the generation_limit that replaces the stored one
    base::Seed seed_{};
    simulation::FirstPopulation first_population_;
    run_file::GenerationBegun begun_; // the beginning of the generation at which the run continues
    std::uint64_t generations_ended_ = 0;
    std::vector<run_file::HashRecord> hashes_; // stored hashes of that generation
    std::size_t compared_ = 0;                 // number of hashes_ that have been compared
    recording::NewRecordFinder new_records_;
};

} // namespace evod::experiments
