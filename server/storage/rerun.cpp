#include "server/storage/rerun.h"

#include "server/protocol/commands.h"

#include <algorithm>
#include <utility>

namespace evod::storage {
namespace {

using base::Refusal;
using base::RefusalCode;
using base::Result;

Refusal damaged(const RunFile& file, const std::string& what) {
    return {.code = RefusalCode::DataLoss, .message = file.path() + " is damaged: " + what, .violations = {}};
}

/// The command that a request was; nothing if it is none that this program knows.
std::optional<simulation::Command> command_of(const std::string& request) {
    v1::Request message;
    if (!message.ParseFromString(request))
        return std::nullopt;
    auto command = protocol::to_command(message, {});
    return command ? std::optional{*std::move(command)} : std::nullopt;
}

} // namespace

Result<std::vector<ParameterChange>> parameter_changes(const RunFile& file, std::span<const JournalEntry> journal) {
    std::vector<ParameterChange> changes;
    std::uint64_t tick = 0;
    for (const JournalEntry& entry : journal) {
        auto command = command_of(entry.origin.request);
        if (!command)
            return damaged(file, "entry " + std::to_string(entry.number) + " of its journal is no command");
        if (entry.tick < tick)
            return damaged(file, "entry " + std::to_string(entry.number) +
                                     " of its journal is from an earlier tick than the one before");
        tick = entry.tick;
        if (auto* change = std::get_if<simulation::SetParameters>(&*command))
            changes.push_back({entry.number, entry.tick, std::move(change->assignments)});
    }
    return changes;
}

Result<Rerun> Rerun::at(RunFile& file, std::uint64_t generation, base::Executor& executor) {
    if (auto refused = file.other_model())
        return *refused;
    const auto journal = file.journal();
    if (!journal)
        return journal.error();
    const auto changes = parameter_changes(file, *journal);
    if (!changes)
        return changes.error();
    const std::uint64_t held = file.held_at_or_before(generation);
    const auto begun = file.beginning_of(held);
    if (!begun)
        return begun.error();
    const std::uint64_t first_generation = file.identity().first_generation;
    if (!*begun && !(generation == 1 && first_generation == 1))
        return Refusal{.code = RefusalCode::NotFound,
                       .message = file.path() + " holds no generation " + std::to_string(generation),
                       .violations = {}};
    if (!*begun)
        return with_changes(
            file, simulation::World{file.identity().parameters, file.identity().seed, file.identity().first_population},
            *changes);
    auto history = file.history(simulation::World::history_generations_kept);
    if (!history)
        return history.error();
    while (!history->empty() && history->back().front().generation >= held)
        history->pop_back();
    auto rerun = from(file, **begun, *changes, *std::move(history), executor);
    while (rerun && rerun->world().moment().generation < generation)
        if (rerun->world().generation_over())
            rerun->turn_over(executor);
        else
            rerun->advance_tick(executor);
    return rerun;
}

Result<Rerun> Rerun::from(const RunFile& file, const GenerationBegun& begun, std::span<const ParameterChange> changes,
                          simulation::World::History history, base::Executor& executor) {
    return with_changes(file,
                        simulation::World{file.identity().seed, begun.opening, begun.born, std::move(history), executor,
                                          file.identity().first_population},
                        changes);
}

Result<Rerun> Rerun::with_changes(const RunFile& file, simulation::World world,
                                  std::span<const ParameterChange> changes) {
    // A change that came between the end of a generation and the beginning of the next is in that beginning already.
    const simulation::Moment& begun = world.moment();
    const auto first = begun.generation == file.identity().first_generation
                           ? changes.begin()
                           : std::ranges::upper_bound(changes, begun.tick, {}, &ParameterChange::tick);
    const simulation::Parameters& active = world.parameters().active;
    simulation::Parameters requested = world.parameters().requested;
    std::vector<Request> requests;
    for (const ParameterChange& change : std::span{first, changes.end()}) {
        // As Laboratory accepted it: whenever generations begin, what waits for a reset stays as it is.
        const auto assigned = simulation::assign(requested, change.assignments);
        if (!assigned || !validate(taking_effect(active, *assigned, base::Effect::NextGeneration)).empty())
            return damaged(file, "entry " + std::to_string(change.entry) +
                                     " of its journal asks for parameters that no world can have");
        requested = *assigned;
        requests.push_back({change.tick, requested});
    }
    return Rerun{std::move(world), std::move(requests)};
}

void Rerun::make_changes() {
    for (; next_ < requests_.size() && requests_[next_].tick <= world_.moment().tick; ++next_)
        world_.request_parameters(requests_[next_].parameters);
}

void Rerun::advance_tick(base::Executor& executor) {
    world_.advance_tick(executor);
    make_changes();
}

void Rerun::advance_to(std::uint64_t tick, base::Executor& executor) {
    while (world_.moment().tick < tick && world_.outcome() == evolution::Outcome::Running)
        advance_tick(executor);
}

Result<Recovered> recover(RunFile& file, base::Executor& executor) {
    const std::uint64_t last_tick = file.contents().tick;
    auto rerun = Rerun::at(file, std::max(file.identity().first_generation, file.last_generation()), executor);
    if (!rerun)
        return rerun.error();
    const std::uint64_t from = rerun->world().moment().tick;
    const auto links = file.links(from, last_tick);
    if (!links)
        return links.error();
    for (const HashLink& link : *links) {
        rerun->advance_to(link.tick, executor);
        if (rerun->world().moment().tick != link.tick || rerun->world().hash() != link.hash)
            return damaged(file, "simulated again, tick " + std::to_string(link.tick) +
                                     " has another state hash than the one that is stored");
    }
    rerun->advance_to(last_tick, executor);
    if (rerun->world().moment().tick != last_tick)
        return damaged(file, "it tells of tick " + std::to_string(last_tick) + ", and the run is over at tick " +
                                 std::to_string(rerun->world().moment().tick));
    auto journal = file.journal();
    if (!journal)
        return journal.error();
    Recovered recovered{std::move(*rerun).take(), {}, *std::move(journal)};
    if (!recovered.journal.empty())
        recovered.control = recovered.journal.back().control;
    simulation::mind_goals(recovered.control, recovered.world);
    return recovered;
}

} // namespace evod::storage
