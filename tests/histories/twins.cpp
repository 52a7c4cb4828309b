#include "tests/histories/twins.h"

#include <variant>

namespace evod::histories {

using simulation::Command;
using simulation::Entry;
using simulation::World;

const Entry* Twins::find(const std::string& name) const {
    const auto found = laboratory_.find(name);
    return found ? *found : nullptr;
}

base::Result<simulation::Applied> Twins::apply(const Command& command) {
    const auto* fork = std::get_if<simulation::ForkWorld>(&command);
    auto applied = fork != nullptr ? this->fork(*fork) : laboratory_.apply(command);
    if (!applied) {
        return applied;
    }
    if (std::holds_alternative<simulation::DeleteWorld>(command)) {
        memories_.erase(applied->world);
        return applied;
    }
    if (std::holds_alternative<simulation::CreateWorld>(command) ||
        std::holds_alternative<simulation::ResetWorld>(command)) {
        begin_memory(applied->world);
    }
    remember(*find(applied->world));
    return applied;
}

base::Result<simulation::Applied> Twins::fork(const simulation::ForkWorld& command) {
    if (!command.at_generation) {
        auto applied = laboratory_.apply(command);
        if (applied) {
            const World& world = find(command.name)->world;
            memories_[command.name].openings.emplace(world.moment().generation, world.at_its_opening(executor_));
        }
        return applied;
    }
    const Memory& before = memories_.at(command.world);
    const auto opening = before.openings.find(*command.at_generation);
    if (opening == before.openings.end()) {
        return base::refusal(base::RefusalCode::NotFound, "the twin does not remember this generation");
    }
    auto applied = laboratory_.adopt(command, opening->second.copy(executor_));
    if (applied) {
        begin_memory(command.name);
    }
    return applied;
}

void Twins::begin_memory(const std::string& name) {
    const World& world = find(name)->world;
    Memory& memory = memories_[name] = {};
    memory.openings.emplace(world.moment().generation, world.copy(executor_));
}

void Twins::remember(const Entry& entry) {
    memories_.at(entry.name).hashes.insert_or_assign(entry.world.moment().tick, entry.world.hash());
}

bool Twins::advance(const std::string& name, std::uint64_t tick) {
    Entry& entry = **laboratory_.find(name);
    World& world = entry.world;
    while (world.moment().tick < tick) {
        if (world.outcome() != evolution::Outcome::Running || world.awaits_fitness()) {
            return false;
        }
        if (world.generation_over()) {
            world.breed_next_generation(executor_);
            memories_.at(name).openings.insert_or_assign(world.moment().generation, world.copy(executor_));
        }
        laboratory_.advance(entry, executor_);
        remember(entry);
    }
    (void)laboratory_.take_events();
    return true;
}

} // namespace evod::histories
