#include "server/storage/rerun.h"

#include "server/base/assert.h"
#include "server/protocol/commands.h"

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

Result<Rerun> Rerun::at(RunFile& file, std::uint64_t generation, base::Executor& executor) {
    if (auto refused = file.other_model())
        return *refused;
    const auto journal = file.journal();
    if (!journal)
        return journal.error();
    const std::uint64_t held = file.held_at_or_before(generation);
    auto begun = file.beginning_of(held);
    if (!begun)
        return begun.error();
    const std::uint64_t first_generation = file.identity().first_generation;
    if (!*begun && !(generation == 1 && first_generation == 1))
        return Refusal{.code = RefusalCode::NotFound,
                       .message = file.path() + " holds no generation " + std::to_string(generation),
                       .violations = {}};
    // A change that came between the end of a generation and the beginning of the next is in that beginning already.
    const std::uint64_t begun_tick = *begun ? (*begun)->opening.moment.tick : 0;
    std::vector<Change> changes;
    for (const JournalEntry& entry : *journal) {
        if (held != first_generation && entry.tick <= begun_tick)
            continue;
        auto command = command_of(entry.origin.request);
        if (!command)
            return damaged(file, "entry " + std::to_string(entry.number) + " of its journal is no command");
        if (auto* change = std::get_if<simulation::SetParameters>(&*command))
            changes.push_back({entry.tick, std::move(*change)});
    }
    if (!*begun) {
        Rerun rerun{simulation::World{file.identity().parameters, file.identity().seed}, std::move(changes)};
        rerun.make_changes();
        return rerun;
    }
    auto history = file.history(simulation::World::history_generations_kept);
    if (!history)
        return history.error();
    while (!history->empty() && history->back().front().generation >= held)
        history->pop_back();
    Rerun rerun{simulation::World{file.identity().seed, (*begun)->opening, std::move((*begun)->born),
                                  *std::move(history), executor},
                std::move(changes)};
    rerun.make_changes();
    while (rerun.world_.moment().generation < generation) {
        if (rerun.world_.generation_over())
            rerun.world_.turn_over(executor);
        else
            rerun.advance_tick(executor);
    }
    return rerun;
}

void Rerun::make_changes() {
    for (; next_ < changes_.size() && changes_[next_].tick <= world_.moment().tick; ++next_) {
        // It was accepted then, and the same rules hold.
        const auto requested =
            simulation::assign(world_.parameters().requested, changes_[next_].command.assignments, "");
        EVOD_ASSERT(requested.has_value());
        world_.request_parameters(*requested);
    }
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
