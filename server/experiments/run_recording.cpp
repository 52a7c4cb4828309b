#include "server/experiments/run_recording.h"

#include "server/base/assert.h"
#include "server/run_file/check.h"
#include "server/run_file/data_folder.h"
#include "server/simulation/founders.h"
#include "server/simulation/world_name.h"

#include <algorithm>
#include <filesystem>
#include <utility>

namespace evod::experiments {
namespace {

using base::RefusalCode;
using base::Result;
using run_file::RunFile;

/// Returns whether the stored population is the given one with its places filled.
bool begins_with(const simulation::FirstPopulation& there, const simulation::FirstPopulation& given,
                 const parameters::Parameters& parameters, base::Seed seed) {
    return simulation::same(there, given) || simulation::same(there, simulation::completed(given, parameters, seed)) ||
           simulation::same(there, simulation::completed(given, parameters, seed, simulation::Filling::Clones));
}

/// Lists how the stored run differs from the requested one: "population_size is 50, not 60; its seed is 3, not 4".
std::string differences_of(const run_file::RunIdentity& there, const parameters::Experiment& wanted,
                           const simulation::FirstPopulation& first_population) {
    std::string text;
    const auto add = [&text](const std::string& difference) { text += (text.empty() ? "" : "; ") + difference; };
    if (wanted.seed && *wanted.seed != there.seed) {
        add("its seed is " + std::to_string(there.seed.value) + ", not " + std::to_string(wanted.seed->value));
    }
    for (const auto* parameter : parameters::parameters_that_differ(there.parameters, wanted.parameters)) {
        add("its " + std::string{parameter->name} + " is " + parameters::to_text(parameter->get(there.parameters)) +
            ", not " + parameters::to_text(parameter->get(wanted.parameters)));
    }
    if (!(there.schedule == wanted.schedule)) {
        add("its schedule of parameters is another one");
    }
    if (!begins_with(there.first_population, first_population, there.parameters, there.seed)) {
        add("its first population is another one");
    }
    return text;
}

/// Whether a run with the limit `wanted` goes on where a run with the limit `stored` ends; 0 means no limit.
bool is_longer(std::uint32_t wanted, std::uint32_t stored) {
    return stored != 0 && (wanted == 0 || wanted > stored);
}

/// Why a run cannot be continued by `evod run`; nullopt if it can.
std::optional<base::Refusal> refusal_of(RunFile& file, const parameters::Experiment& experiment,
                                        const simulation::FirstPopulation& first_population) {
    if (auto refused = file.other_model()) {
        return refused;
    }
    const auto refused = [&](const std::string& why) {
        return refusal(RefusalCode::FailedPrecondition, file.path() + why);
    };
    if (file.identity().forked_from) {
        return refused(" contains a fork of another run, which only a server can continue: name another file");
    }
    if (file.journal().last_number() > 0) {
        return refused(" contains commands of clients, so only a server can continue it: name another file");
    }
    run_file::RunIdentity longer = file.identity();
    if (is_longer(experiment.parameters.generation_limit, longer.parameters.generation_limit)) {
        longer.parameters.generation_limit = experiment.parameters.generation_limit;
    }
    if (const std::string text = differences_of(longer, experiment, first_population); !text.empty()) {
        return refused(" contains another run: " + text + "; name another file, or continue with the same values");
    }
    return std::nullopt;
}

/// Whether the run is over after the last generation in its file.
///
/// limit  the generation_limit of the run
Result<bool> is_over(RunFile& file, std::uint64_t generation, std::uint32_t limit) {
    const auto opening = file.generations().opening_of(generation);
    if (!opening) {
        return opening.error();
    }
    const auto statistics = file.generations().statistics_of(generation);
    if (!statistics) {
        return statistics.error();
    }
    if (!*opening || statistics->empty()) {
        return false;
    }
    const parameters::ParameterSet& set = (*opening)->parameters;
    auto active = parameters::taking_effect(set.active, set.requested, base::Effect::NextTick);
    active.generation_limit = limit;
    const bool lived = std::ranges::any_of(*statistics, [](const auto& island) { return island.alive_count > 0; });
    const double best = std::ranges::max(*statistics, {}, &simulation::GenerationStatistics::fitness_best).fitness_best;
    const evolution::Progress progress =
        evolution::advance((*opening)->progress, {best, parameters::has_bodies(active) && !lived});
    return evolution::outcome(progress, active, parameters::has_births(active)) != evolution::Outcome::Running;
}

} // namespace

Result<std::unique_ptr<RunRecording>> RunRecording::open(std::string path, const parameters::Experiment& experiment,
                                                         const simulation::FirstPopulation& first_population) {
    std::unique_ptr<RunRecording> recording{new RunRecording{std::move(path)}};
    if (auto examined = recording->examine(experiment, first_population); !examined) {
        return examined.error();
    }
    return recording;
}

Result<void> RunRecording::examine(const parameters::Experiment& experiment,
                                   const simulation::FirstPopulation& first_population) {
    auto lock = run_file::RunFileLock::take(path_);
    if (!lock) {
        return lock.error();
    }
    lock_.emplace(*std::move(lock));
    std::error_code error;
    if (!exists(std::filesystem::symlink_status(path_, error))) {
        return {};
    }
    const auto file = RunFile::open_checked(path_);
    if (!file) {
        return file.error();
    }
    if (auto single = run_file::expect_file_with_one_name(path_); !single) {
        return single;
    }
    if (auto whole = check_end_mark(**file); !whole) {
        return whole;
    }
    if (auto refused = refusal_of(**file, experiment, first_population)) {
        return *std::move(refused);
    }
    return read_part(**file, experiment);
}

Result<void> RunRecording::read_part(RunFile& file, const parameters::Experiment& experiment) {
    const std::uint64_t last = file.generations().last();
    seed_ = file.identity().seed;
    first_population_ = file.identity().first_population;
    generations_ended_ = file.generations().last_ended();
    const std::uint32_t limit = experiment.parameters.generation_limit;
    if (limit != file.identity().parameters.generation_limit) {
        longer_limit_ = limit;
    }
    const auto over = is_over(file, last, limit);
    if (!over) {
        return over.error();
    }
    stored_ = *over ? Stored::Whole : Stored::Part;
    auto begun = file.generations().beginning_of(last);
    if (!begun) {
        return begun.error();
    }
    if (!*begun) {
        return file.damaged("the beginning of generation " + std::to_string(last));
    }
    begun_ = **std::move(begun);
    if (longer_limit_) {
        parameters::ParameterSet& set = begun_.opening.parameters;
        set.active.generation_limit = set.requested.values.generation_limit = limit;
    }
    auto hashes = file.hashes(begun_.opening.moment.tick, file.last_tick());
    if (!hashes) {
        return hashes.error();
    }
    hashes_ = *std::move(hashes);
    return {};
}

std::optional<base::Seed> RunRecording::seed() const {
    return stored_ == Stored::Nothing ? std::nullopt : std::optional{seed_};
}

simulation::World RunRecording::continued_world(const parameters::Experiment& experiment,
                                                simulation::FirstPopulation first_population, base::Executor& executor,
                                                simulation::IslandsMaker* maker) {
    EVOD_ASSERT(stored_ == Stored::Part);
    return {seed_,
            begun_.opening,
            {std::exchange(begun_.born, {}), std::exchange(begun_.founders, {})},
            {},
            executor,
            std::move(first_population),
            experiment.schedule,
            maker};
}

Result<void>
RunRecording::read_statistics(const std::function<void(const std::vector<simulation::GenerationStatistics>&)>& use) {
    if (stored_ == Stored::Nothing) {
        return {};
    }
    const auto file = RunFile::open_read_only(path_);
    if (!file) {
        return file.error();
    }
    const std::uint64_t end = continues_at() + (stored_ == Stored::Whole ? 1 : 0);
    for (std::uint64_t generation = (*file)->identity().first_generation; generation < end; ++generation) {
        const auto statistics = (*file)->generations().statistics_of(generation);
        if (!statistics) {
            return statistics.error();
        }
        if (statistics->empty()) {
            return (*file)->damaged("the statistics of generation " + std::to_string(generation));
        }
        use(*statistics);
    }
    return {};
}

Result<void> RunRecording::begin(const simulation::World& world, const simulation::RunId& run_id) {
    const std::uint64_t generation = world.moment().generation;
    if (stored_ == Stored::Nothing) {
        new_records_ = {world.moment().tick, generation, 0};
        return create(run_id, run_file::beginning_of(world), world);
    }
    new_records_ = {hashes_.empty() ? world.moment().tick : hashes_.back().tick, generation, generations_ended_};
    auto file = RunFile::open(path_, {});
    if (!file) {
        return file.error();
    }
    file_ = *std::move(file);
    file_->begin();
    return longer_limit_ ? file_->set_generation_limit(*longer_limit_) : Result<void>{};
}

Result<void> RunRecording::create(const simulation::RunId& run_id, const run_file::GenerationBegun& begun,
                                  const simulation::World& world) {
    const std::string stem = std::filesystem::path{path_}.stem().string();
    auto file = RunFile::create(
        path_, run_file::identity_of(world, simulation::is_world_name(stem) ? stem : "run", run_id), {}, {begun});
    if (!file) {
        return file.error();
    }
    file_ = *std::move(file);
    file_->begin();
    return {};
}

Result<void> RunRecording::follow(const simulation::World& world) {
    new_records_.report(world, [this](const auto& record) { file_->write(record); });
    if (compared_ < hashes_.size() && hashes_[compared_].tick == world.moment().tick &&
        hashes_[compared_++].hash != world.hash()) {
        return refusal(RefusalCode::DataLoss, path_ + " is damaged: the stored state hash of tick " +
                                                  std::to_string(world.moment().tick) +
                                                  " differs from that of a new simulation");
    }
    return {};
}

Result<void> RunRecording::commit() {
    if (auto committed = file_->commit(); !committed) {
        return committed;
    }
    if (auto thinned = file_->shrink_if_large(); !thinned) {
        return thinned;
    }
    for (auto more = file_->purge_step(); !more || *more; more = file_->purge_step()) {
        if (!more) {
            return more.error();
        }
    }
    run_file::Database& database = file_->database().database;
    if (database.log_pages() > RunFile::Options{}.log_pages_max) {
        database.copy_log();
    }
    file_->begin();
    return {};
}

Result<void> RunRecording::close(const simulation::World& world) {
    if (!file_) {
        return {}; // begin() has failed
    }
    file_->write(run_file::EndMark{.tick = std::max(file_->last_tick(), world.moment().tick)});
    auto committed = file_->commit();
    file_.reset();
    return committed;
}

} // namespace evod::experiments
