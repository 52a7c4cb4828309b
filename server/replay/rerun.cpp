#include "server/replay/rerun.h"

#include "server/base/overloaded.h"
#include "server/protocol/commands.h"
#include "server/replay/past_changes.h"
#include "server/run_file/checkpoint.h"
#include "server/simulation/entities.h"
#include "server/simulation/opening_check.h"
#include "server/simulation/rating.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <type_traits>
#include <utility>

namespace evod::replay {
namespace {

using base::Refusal;
using base::RefusalCode;
using base::Result;

Refusal damaged(const std::string& path, const std::string& what) {
    return {.code = RefusalCode::DataLoss, .message = path + " is damaged: " + what, .violations = {}};
}
Refusal damaged(const run_file::RunFile& file, const std::string& what) {
    return damaged(file.path(), what);
}

std::size_t bytes_of(const simulation::PlaceEntities& command) {
    std::size_t bytes = command.items.size() * sizeof(simulation::PlaceEntities::Item);
    for (const simulation::PlaceEntities::Organism& organism : command.organisms) {
        bytes += sizeof organism + organism.genes.size() * sizeof(float);
    }
    return bytes;
}
std::size_t bytes_of(const simulation::RemoveEntities& command) {
    return (command.food.size() + command.poison.size() + command.organisms.size()) * sizeof(std::uint32_t);
}
std::size_t bytes_of(const simulation::SetFitness& command) {
    return command.fitness.size() * sizeof(double) + command.genes.size() * sizeof(float);
}

Refusal impossible_change(const std::string& path, const WorldChange& change) {
    return damaged(path, "entry " + std::to_string(change.entry) +
                             " of its journal is a change that no server could have accepted");
}

/// The command in a serialized request; nullopt if this program does not recognise it as a command.
std::optional<simulation::Command> command_of(const std::string& request) {
    v1::Request message;
    if (!message.ParseFromString(request)) {
        return std::nullopt;
    }
    auto command = protocol::to_command(message, {});
    return command ? std::optional{*std::move(command)} : std::nullopt;
}

std::optional<CheckedCommand> checked_command(simulation::Command command) {
    return std::visit(
        []<class C>(C& kind) -> std::optional<CheckedCommand> {
            if constexpr (std::is_constructible_v<CheckedCommand, std::in_place_type_t<C>, C>) {
                return std::move(kind);
            }
            return std::nullopt;
        },
        command);
}

/// Returns the number of the last journal entry that a beginning of a generation, or a checkpoint of it, contains.
std::uint64_t last_entry_before(const run_file::RunFile& file, const run_file::GenerationBegun& begun,
                                const run_file::StoredCheckpoint* checkpoint, std::span<const WorldChange> changes) {
    if (checkpoint != nullptr) {
        // Changes after the same tick may be older or newer than the checkpoint, so they are distinguished by journal
        // entry.
        return checkpoint->journal_entries;
    }
    // The stored beginning of a generation already contains the changes between the end of the previous generation and
    // the first tick.
    const simulation::Moment& opening = begun.opening.moment;
    const auto first = opening.generation == file.identity().first_generation
                           ? changes.begin()
                           : std::ranges::upper_bound(changes, opening.tick, {}, &WorldChange::tick);
    return first == changes.begin() ? 0 : std::prev(first)->entry;
}

/// Returns whether the chromosomes of an island can be those of organisms that live there.
///
/// is_opened  whether the interval begins with an opening, which decides how many organisms there are.
bool are_possible(const evolution::NextGeneration& island, bool is_opened, parameters::Parameters parameters) {
    const evolution::GeneMatrix& genes = island.genes;
    if (!is_opened && genes.cols() != static_cast<Eigen::Index>(parameters.population_size) + island.predator_count) {
        return false;
    }
    if (genes.cols() == 0) {
        return is_opened;
    }
    constexpr float greatest = 1e12f;               // no parameter and no list of free genes allows a gene beyond it
    if (!(genes.array().abs() <= greatest).all()) { // a NaN fails each comparison
        return false;
    }
    const evolution::FreeGeneOperators listed{parameters};
    for (std::uint32_t organism = 0; organism < genes.cols() && !listed.empty(); ++organism) {
        if (listed.first_fault(evolution::column(genes, organism))) {
            return false;
        }
    }
    if (!evolution::has_body_genes(parameters)) {
        return true;
    }
    if (!(genes.topRows(evolution::body_gene_count).array() >= 0).all() ||
        !(genes.row(evolution::BodySize).array() > 0).all()) {
        return false;
    }
    const auto widest = static_cast<double>(genes.row(evolution::BodySize).maxCoeff());
    parameters.body_size_max = std::max(parameters.body_size_max, widest);
    return parameters::validate(parameters).empty(); // the organisms have room
}

/// Returns what no server could have written in the beginning of a generation; nullptr if there is nothing. Row
/// checksums find damaged bytes, but not what another program has written.
const char* impossible_part_of(const run_file::GenerationBegun& begun) {
    const simulation::Moment& moment = begun.opening.moment;
    const parameters::ParameterSet& set = begun.opening.parameters;
    const auto is_valid_from = [&](base::Effect reached) {
        return parameters::validate(parameters::taking_effect(set.active, set.requested, reached)).empty();
    };
    if (moment.generation < 1 || !(moment.simulated_s >= 0) || !std::isfinite(moment.simulated_s)) {
        return "moment";
    }
    if (!parameters::validate(set.active).empty() || !is_valid_from(base::Effect::NextTick) ||
        !is_valid_from(base::Effect::NextGeneration)) {
        return "parameters";
    }
    const bool possible = std::ranges::all_of(begun.born, [&](const evolution::NextGeneration& island) {
        return are_possible(island, !begun.openings.empty(), set.active);
    });
    if (!possible) {
        return "population";
    }
    for (std::size_t i = 0; i < begun.openings.size(); ++i) {
        if (const char* fault = simulation::fault_of(begun.openings[i], begun.born[i], set.active)) {
            return fault;
        }
    }
    return nullptr;
}

/// Adds the changes of these journal entries.
///
/// tick  of the entry before; becomes that of the last one.
Result<void> add_changes(const std::string& path, std::span<const run_file::JournalEntry> journal, std::uint64_t& tick,
                         std::vector<WorldChange>& changes) {
    for (const run_file::JournalEntry& entry : journal) {
        auto command = command_of(entry.origin.request);
        if (!command) {
            return damaged(path, "entry " + std::to_string(entry.number) + " of its journal is not a command");
        }
        if (entry.tick < tick) {
            return damaged(path, "entry " + std::to_string(entry.number) +
                                     " of its journal has an earlier tick than the previous entry");
        }
        tick = entry.tick;
        if (auto* change = std::get_if<simulation::SetParameters>(&*command)) {
            changes.push_back({entry.number, entry.tick, std::move(change->assignments), change->at, entry.origin.by});
        }
        if (const auto* cancel = std::get_if<simulation::CancelChange>(&*command)) {
            changes.push_back({.entry = entry.number, .tick = entry.tick, .assignments = {}, .cancels = cancel->id});
        }
        if (auto checked = checked_command(*std::move(command))) {
            changes.push_back({.entry = entry.number,
                               .tick = entry.tick,
                               .assignments = {},
                               .checked = std::make_shared<const CheckedCommand>(*std::move(checked))});
        }
    }
    return {};
}

} // namespace

std::size_t bytes_of(const WorldChange& change) {
    std::size_t bytes = sizeof change + change.by.user.size() + change.by.program.size() + change.by.address.size() +
                        change.assignments.capacity() * sizeof(parameters::Assignment);
    if (change.checked) {
        bytes +=
            sizeof *change.checked + std::visit([](const auto& command) { return bytes_of(command); }, *change.checked);
    }
    return bytes;
}

base::Refusal cancelled_refusal() {
    return refusal(RefusalCode::Unavailable, "reading was cancelled");
}

Result<std::vector<WorldChange>> world_changes(run_file::RunFile& file, std::uint64_t after_entry,
                                               const base::StopCheck& stop) {
    constexpr std::uint32_t entries_at_once = 1000;
    std::vector<WorldChange> changes;
    std::uint64_t tick = 0;
    while (true) {
        if (stop()) {
            return cancelled_refusal();
        }
        const auto journal = file.journal().read(after_entry + 1, entries_at_once);
        if (!journal) {
            return journal.error();
        }
        if (auto added = add_changes(file.path(), *journal, tick, changes); !added) {
            return added.error();
        }
        if (journal->size() < entries_at_once) {
            return changes;
        }
        after_entry += entries_at_once;
    }
}

Result<std::vector<WorldChange>> world_changes(const std::string& path,
                                               std::span<const run_file::JournalEntry> journal) {
    std::vector<WorldChange> changes;
    std::uint64_t tick = 0;
    if (auto added = add_changes(path, journal, tick, changes); !added) {
        return added.error();
    }
    return changes;
}

Result<std::vector<WorldChange>> Rerun::changes_of(run_file::RunFile& file, const base::StopCheck& stop) {
    if (auto refused = file.other_model()) {
        return *refused;
    }
    return world_changes(file, 0, stop);
}

Result<Rerun> Rerun::at(run_file::RunFile& file, std::uint64_t generation, base::Executor& executor) {
    const auto changes = changes_of(file);
    if (!changes) {
        return changes.error();
    }
    auto rerun = begun_at(file, file.retention().at_or_before(generation), nullptr, *changes,
                          simulation::history_generations_kept, executor);
    if (!rerun && rerun.error().code == RefusalCode::NotFound) {
        return Refusal{.code = RefusalCode::NotFound,
                       .message = file.path() + " has no generation " + std::to_string(generation),
                       .violations = {},
                       .reason = base::Reason::MomentNotFound};
    }
    while (rerun && rerun->world().moment().generation < generation && !rerun->changes().fault()) {
        if (rerun->world().generation_over()) {
            rerun->breed_next_generation(executor);
        } else {
            rerun->advance_tick(executor);
        }
    }
    if (rerun && rerun->changes().fault()) {
        return *rerun->changes().fault();
    }
    return rerun;
}

Result<Rerun> Rerun::before(run_file::RunFile& file, std::uint64_t generation, std::uint64_t tick,
                            std::size_t history_count, base::Executor& executor, const base::StopCheck& stop) {
    const auto changes = changes_of(file, stop);
    if (!changes) {
        return changes.error();
    }
    return before(file, generation, tick, *changes, history_count, executor);
}

Result<Rerun> Rerun::before(run_file::RunFile& file, std::uint64_t tick, base::Executor& executor) {
    if (tick < file.identity().first_tick || tick > file.last_tick()) {
        return Refusal{.code = RefusalCode::NotFound,
                       .message = file.path() + " does not contain tick " + std::to_string(tick),
                       .violations = {},
                       .reason = base::Reason::MomentNotFound};
    }
    return before(file, file.generations().at_tick(tick), tick, simulation::history_generations_kept, executor);
}

Result<Rerun> Rerun::before(run_file::RunFile& file, std::uint64_t generation, std::uint64_t tick,
                            std::span<const WorldChange> changes, std::size_t history_count, base::Executor& executor) {
    const std::uint64_t retained = file.retention().at_or_before(generation);
    const auto checkpoint = file.checkpoints().last(tick);
    if (!checkpoint) {
        return checkpoint.error();
    }
    const bool is_later =
        *checkpoint && (*checkpoint)->moment.generation >= retained && (*checkpoint)->moment.generation <= generation;
    if (is_later) {
        return begun_at(file, (*checkpoint)->moment.generation, &**checkpoint, changes, history_count, executor);
    }
    return begun_at(file, retained, nullptr, changes, history_count, executor);
}

Result<Rerun> Rerun::begun_at(run_file::RunFile& file, std::uint64_t generation,
                              const run_file::StoredCheckpoint* checkpoint, std::span<const WorldChange> changes,
                              std::size_t history_count, base::Executor& executor) {
    const run_file::RunIdentity& identity = file.identity();
    const auto begun = file.generations().beginning_of(generation);
    if (!begun) {
        return begun.error();
    }
    if (!*begun && (generation != 1 || identity.forked_from)) {
        return Refusal{.code = RefusalCode::NotFound,
                       .message =
                           file.path() + " does not retain the beginning of generation " + std::to_string(generation),
                       .violations = {}};
    }
    if (!*begun) {
        return with_changes(
            file, simulation::World{identity.parameters, identity.seed, identity.first_population, identity.schedule},
            changes, 0);
    }
    // A fork that begins within a generation, or after entities were placed or removed before its first tick, starts
    // from the checkpoint at its first tick.
    std::optional<run_file::StoredCheckpoint> first;
    if (checkpoint == nullptr && generation == identity.first_generation && identity.forked_from) {
        auto found = file.checkpoints().last(identity.first_tick);
        if (!found) {
            return found.error();
        }
        if (*found && (*found)->moment.tick == identity.first_tick) {
            first = *std::move(found);
            checkpoint = &*first;
        } else if ((*begun)->opening.moment.tick < identity.first_tick) {
            return damaged(file, "the checkpoint with which the run begins is missing");
        }
    }
    const std::size_t islands = (*begun)->born.size();
    auto history = file.generations().history(
        generation, std::min(history_count, simulation::history_generations_kept_of(
                                                std::max<std::size_t>(islands, 1),
                                                evolution::gene_count((*begun)->opening.parameters.active))));
    if (!history) {
        return history.error();
    }
    simulation::Changes past;
    if (history_count > 0) {
        const auto& moment = checkpoint != nullptr ? checkpoint->moment : (*begun)->opening.moment;
        past = past_changes(file, changes, last_entry_before(file, **begun, checkpoint, changes), moment);
    }
    return from(file, **begun, checkpoint, changes, *std::move(history), executor, std::move(past));
}

Result<Rerun> Rerun::from(const run_file::RunFile& file, const run_file::GenerationBegun& begun,
                          const run_file::StoredCheckpoint* checkpoint, std::span<const WorldChange> changes,
                          simulation::History history, base::Executor& executor, simulation::Changes past) {
    if (const char* part = impossible_part_of(begun)) {
        return damaged(file, "generation " + std::to_string(begun.opening.moment.generation) +
                                 " begins with an impossible " + part);
    }
    simulation::World world{file.identity().seed,    begun.opening, begun.bred(),
                            std::move(history),      executor,      file.identity().first_population,
                            file.identity().schedule};
    world.set_past_changes(std::move(past));
    const std::uint64_t last_entry = last_entry_before(file, begun, checkpoint, changes);
    if (checkpoint == nullptr) {
        return with_changes(file, std::move(world), changes, last_entry);
    }
    const auto unusable = [&](const std::string& why) {
        return damaged(file, "its checkpoint after tick " + std::to_string(checkpoint->moment.tick) +
                                 " does not belong to this run: " + why);
    };
    simulation::WorldState state{
        .moment = checkpoint->moment, .parameters = checkpoint->parameters, .islands = {}, .ended = {}};
    if (const auto unpacked = run_file::unpack(checkpoint->state, world.shapes(), state); !unpacked) {
        return unusable(unpacked.error().message);
    }
    if (const auto restored = world.restore(state, executor); !restored) {
        return unusable(restored.error().message);
    }
    if (world.hash() != checkpoint->hash) {
        return unusable("its state hash differs from the stored one");
    }
    return with_changes(file, std::move(world), changes, last_entry);
}

Result<Rerun> Rerun::with_changes(const run_file::RunFile& file, simulation::World world,
                                  std::span<const WorldChange> changes, std::uint64_t after_entry) {
    if (auto planned = ComingChanges::restore_planned_changes(file.path(), changes, after_entry, world); !planned) {
        return planned.error();
    }
    ComingChanges coming{after_entry};
    if (auto extended = coming.extend(file.path(), changes); !extended) {
        return extended.error();
    }
    Rerun rerun{std::move(world), std::move(coming)};
    if (const auto& fault = rerun.changes().fault()) {
        return *fault;
    }
    return rerun;
}

Result<void> ComingChanges::restore_planned_changes(const std::string& path, std::span<const WorldChange> changes,
                                                    std::uint64_t after_entry, simulation::World& world) {
    for (const WorldChange& change : changes) {
        if (change.entry > after_entry) {
            break;
        }
        if (change.cancels && !world.cancel(*change.cancels)) {
            return impossible_change(path, change);
        }
        if (!change.at) {
            continue;
        }
        if (std::ranges::any_of(change.assignments,
                                [](const auto& assignment) { return fault_of(assignment).has_value(); }) ||
            (change.at->tick && *change.at->tick <= change.tick)) {
            return impossible_change(path, change);
        }
        (void)world.plan({.id = 0, .at = *change.at, .assignments = change.assignments, .by = change.by});
    }
    world.drop_due_changes();
    return {};
}

Result<void> ComingChanges::extend(const std::string& path, std::span<const WorldChange> changes) {
    for (const WorldChange& change : changes) {
        if (change.entry <= last_entry_) {
            continue;
        }
        for (const parameters::Assignment& assignment : change.assignments) {
            if (fault_of(assignment)) {
                return impossible_change(path, change);
            }
        }
        last_entry_ = change.entry;
        changes_.push_back(change);
        bytes_ += bytes_of(change);
    }
    path_ = path;
    return {};
}

bool ComingChanges::apply(const WorldChange& change, simulation::World& world) {
    if (change.cancels) {
        return world.cancel(*change.cancels).has_value();
    }
    if (change.checked) {
        const auto can_be = [&](const auto& command) { return check(world, command).has_value(); };
        const auto carry_out =
            base::Overloaded{[&](const simulation::PlaceEntities& command) { (void)world.place(command); },
                             [&](const simulation::RemoveEntities& command) { (void)world.remove(command); },
                             [&](const simulation::SetFitness& command) { world.set_fitness(command); }};
        if (!std::visit(can_be, *change.checked)) {
            return false;
        }
        std::visit(carry_out, *change.checked);
        return true;
    }
    if (change.at) {
        const bool can_be = world.is_in_future(*change.at) && world.planned().size() < parameters::planned_changes_max;
        if (can_be) {
            (void)world.plan({.id = 0, .at = *change.at, .assignments = change.assignments, .by = change.by});
        }
        return can_be;
    }
    const auto requested = request_of(world.parameters(), change.assignments);
    if (requested) {
        world.request_parameters(*requested, change.by);
    }
    return requested.has_value();
}

void ComingChanges::apply_due(simulation::World& world, std::uint64_t last) {
    const auto is_due = [&](const WorldChange& change) {
        return change.tick <= world.moment().tick && change.entry <= last;
    };
    while (!fault_ && !changes_.empty() && is_due(changes_.front())) {
        if (!apply(changes_.front(), world)) {
            fault_ = impossible_change(path_, changes_.front());
        }
        bytes_ -= bytes_of(changes_.front());
        changes_.pop_front();
    }
}

void ComingChanges::fail_without_fitness(std::uint64_t generation) {
    fault_ = damaged(path_, "its journal does not contain the fitness of generation " + std::to_string(generation));
}

void Rerun::advance_tick(base::Executor& executor, std::uint64_t last) {
    if (world_.awaits_fitness()) {
        return changes_.fail_without_fitness(world_.moment().generation);
    }
    world_.advance_tick(executor);
    hash_of_tick_ = world_.hash();
    apply_changes(last);
}

void Rerun::advance_to(std::uint64_t tick, base::Executor& executor) {
    while (world_.moment().tick < tick && world_.outcome() == evolution::Outcome::Running && !changes_.fault()) {
        advance_tick(executor);
    }
}

} // namespace evod::replay
