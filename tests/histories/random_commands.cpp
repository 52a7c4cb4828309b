#include "tests/histories/random_commands.h"

#include "server/evolution/gene_layout.h"
#include "server/parameters/schedule.h"
#include "server/protocol/parameters.h"
#include "tests/histories/random_worlds.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

namespace evod::histories {

using simulation::Entry;
using simulation::World;

namespace {

constexpr std::size_t worlds_wanted = 4;

/// How many ticks a generation of this world has at most, now and after the changes that wait.
double generation_ticks(const World& world) {
    const auto ticks = [](const parameters::Parameters& p) {
        return parameters::has_bodies(p) ? std::ceil(p.generation_s / p.tick_s) : 1;
    };
    return std::max(ticks(world.parameters().active), ticks(world.parameters().requested.values));
}

} // namespace

v1::Request RandomCommands::request() {
    v1::Request request;
    request.set_client_key("test");
    request.set_request_id(++requests_);
    return request;
}

std::vector<v1::Request> RandomCommands::next(const Twins& twins) {
    const auto entries = twins.laboratory().entries();
    if (entries.empty() || (entries.size() < worlds_wanted && draws_.chance(0.03))) {
        return {create()};
    }
    const Entry& entry = *draws_.one_of(entries);
    if (entry.world.awaits_fitness() && draws_.chance(0.7)) {
        return {set_fitness(entry)};
    }
    std::uint64_t kind = draws_.below(100);
    if (entry.world.moment().generation_tick == 0 && draws_.chance(0.5)) {
        kind = draws_.count(30, 99); // much can happen before the first tick
    }
    if (kind < 30) {
        return advance(entry);
    }
    if (kind < 56) {
        return {set_parameters(entry)};
    }
    if (kind < 60) {
        return {cancel(entry)};
    }
    if (kind < 70) {
        return {place(entry)};
    }
    if (kind < 78) {
        return {remove(entry)};
    }
    if (kind < 81) {
        return {reset(entry)};
    }
    if (kind < 90 && entries.size() < 2 * worlds_wanted) {
        return {fork(entry, twins.memory(entry.name))};
    }
    if (kind < 92 && entries.size() > 1) {
        v1::Request deletion = request();
        deletion.mutable_delete_world()->set_world(entry.name);
        return {deletion};
    }
    if (kind < 93) {
        return {set_fitness(entry)}; // which is refused if it is not awaited
    }
    if (kind < 94) {
        v1::Request noted = request();
        noted.mutable_add_note()->set_world(entry.name);
        noted.mutable_add_note()->set_kind("remark");
        noted.mutable_add_note()->set_text("a note");
        return {noted};
    }
    return control(entry);
}

v1::Request RandomCommands::create() {
    v1::Request created = random_world(unused_name(), draws_);
    created.set_request_id(++requests_);
    return created;
}

v1::Request RandomCommands::until(const Entry& entry, std::uint64_t tick) {
    v1::Request until = request();
    until.mutable_run_until_tick()->set_world(entry.name);
    until.mutable_run_until_tick()->set_tick(tick);
    return until;
}

std::vector<v1::Request> RandomCommands::advance(const Entry& entry) {
    const std::uint64_t now = entry.world.moment().tick;
    if (draws_.chance(0.2) && generation_ticks(entry.world) < 200) {
        v1::Request run = request();
        run.mutable_run()->set_world(entry.name);
        run.mutable_run()->set_generations(draws_.count(1, 3));
        return {run};
    }
    constexpr std::uint32_t most[] = {1, 3, 20, 60, 60, 200};
    const std::uint64_t tick = now + draws_.count(1, draws_.one_of(most));
    if (draws_.chance(0.1)) { // up to the end of the tick that has a stored state hash
        return {until(entry, (now / 60 + 1) * 60)};
    }
    return {until(entry, tick)};
}

std::vector<v1::Request> RandomCommands::control(const Entry& entry) {
    const auto of_world = [&](auto mutable_kind) {
        v1::Request sent = request();
        (sent.*mutable_kind)()->set_world(entry.name);
        return sent;
    };
    const v1::Request pause = of_world(&v1::Request::mutable_pause);
    const std::uint64_t later = entry.world.moment().tick + draws_.count(1, 60);
    switch (draws_.below(5)) {
    case 0:
        return {pause};
    case 1: { // the goal stays, behind a pause or a lease
        const v1::Request run = of_world(&v1::Request::mutable_run);
        return draws_.chance(0.5) ? std::vector{run, pause} : std::vector{run, until(entry, later)};
    }
    case 2:
        return {of_world(&v1::Request::mutable_release_lease), pause};
    case 3:
        return {of_world(&v1::Request::mutable_resume), until(entry, later)};
    default:
        v1::Request speed = of_world(&v1::Request::mutable_set_speed);
        if (draws_.chance(0.5)) {
            speed.mutable_set_speed()->mutable_speed()->set_max(true);
        } else {
            speed.mutable_set_speed()->mutable_speed()->set_real_time_factor(draws_.number(0.5, 100));
        }
        return {speed};
    }
}

v1::Request RandomCommands::set_parameters(const Entry& entry) {
    const World& world = entry.world;
    v1::Request sent = request();
    v1::SetParameters& set = *sent.mutable_set_parameters();
    set.set_world(entry.name);
    const parameters::ParameterDescription& first = turns_.next();
    const bool at_once = first.effect == base::Effect::Reset || draws_.chance(0.4);
    const bool at_generation = !at_once && draws_.chance(0.5);
    if (at_generation) {
        set.set_at_generation(world.moment().generation + draws_.count(1, 3));
    } else if (!at_once) {
        set.set_at_tick(world.moment().tick + draws_.count(1, 90));
    }
    set.set_dry_run(draws_.chance(0.03));
    if (draws_.chance(0.05)) {
        set.set_expected_revision(world.parameters().revision + draws_.below(2));
    }
    std::vector<parameters::Assignment> assignments;
    for (int tries = 0; tries < 8; ++tries) { // most of what clients request is accepted
        assignments = random_assignments(first, at_once, draws_);
        const auto requested = (at_generation ? parameters::request_at_generation
                                              : parameters::request_of)(world.parameters(), assignments, "");
        if (requested) {
            break;
        }
    }
    for (const parameters::Assignment& assignment : assignments) {
        v1::ParameterAssignment& added = *set.add_parameters();
        added.set_name(assignment.name);
        *added.mutable_value() = protocol::to_proto(assignment.value);
    }
    return sent;
}

v1::Request RandomCommands::cancel(const Entry& entry) {
    v1::Request sent = request();
    sent.mutable_cancel_change()->set_world(entry.name);
    const auto& planned = entry.world.planned();
    sent.mutable_cancel_change()->set_id(planned.empty() ? draws_.count(1, 4) : draws_.one_of(planned).id);
    return sent;
}

v1::Request RandomCommands::place(const Entry& entry) {
    const parameters::Parameters& p = entry.world.parameters().active;
    const parameters::IslandPlan plan = parameters::island_plan(p);
    v1::Request sent = request();
    v1::Place& place = *sent.mutable_place();
    place.set_world(entry.name);
    place.set_island(draws_.count(0, p.island_count - 1));
    for (std::uint32_t count = draws_.count(1, 3); count > 0; --count) {
        const double x = draws_.number(0, plan.width_px), y = draws_.number(0, plan.height_px);
        if (draws_.chance(0.4)) {
            v1::PlacedItem& item = *place.add_items();
            item.set_kind(draws_.chance(0.5) ? v1::ITEM_KIND_FOOD : v1::ITEM_KIND_POISON);
            item.set_x_px(x);
            item.set_y_px(y);
        } else {
            v1::PlacedOrganism& organism = *place.add_organisms();
            organism.set_x_px(x);
            organism.set_y_px(y);
            const auto genes = evolution::initial_population(1, p, base::Seed{draws_.below(1000)}, 0);
            organism.mutable_genes()->Add(genes.data(), genes.data() + genes.size());
        }
    }
    return sent;
}

v1::Request RandomCommands::remove(const Entry& entry) {
    v1::Request sent = request();
    v1::Remove& remove = *sent.mutable_remove();
    remove.set_world(entry.name);
    remove.set_island(draws_.count(0, entry.world.island_count() - 1));
    if (draws_.chance(0.1)) {
        remove.set_generation(entry.world.moment().generation - draws_.below(2));
    }
    const auto& cause = entry.world.island(remove.island()).life_records().cause;
    const bool all = draws_.chance(0.4);
    for (std::uint32_t id = 0; id < cause.size(); ++id) {
        if (cause[id] == simulation::CauseOfDeath::Alive && (all || draws_.chance(0.2))) {
            remove.add_organisms(id);
        }
    }
    if (remove.organisms().empty() || draws_.chance(0.3)) {
        remove.add_food(draws_.count(0, 3)); // refused if it is absent
    }
    if (draws_.chance(0.1)) {
        remove.add_poison(draws_.count(0, 3));
    }
    return sent;
}

v1::Request RandomCommands::set_fitness(const Entry& entry) {
    const World& world = entry.world;
    v1::Request sent = request();
    v1::SetFitness& set = *sent.mutable_set_fitness();
    set.set_world(entry.name);
    set.set_generation(world.moment().generation);
    std::uint32_t island = 0;
    while (island + 1 < world.island_count() && world.awaits_fitness() && world.is_rated(island)) {
        ++island;
    }
    set.set_island(island);
    const std::uint32_t objectives = world.parameters().active.objectives;
    const auto given =
        world.ratings().empty() ? 0 : static_cast<std::uint32_t>(world.ratings()[island].fitness.size() / objectives);
    const std::uint32_t count = world.organism_count(island);
    set.set_first_organism(given < count && draws_.chance(0.9) ? given : 0);
    const std::uint32_t missing = count - set.first_organism();
    const std::uint32_t sent_count = missing > 1 && draws_.chance(0.25) ? draws_.count(1, missing - 1) : missing;
    for (std::uint32_t i = 0; i < sent_count * objectives; ++i) {
        set.add_fitness(draws_.chance(0.1) ? 0 : draws_.number(-5, 5));
    }
    const evolution::GeneBounds bounds = evolution::gene_bounds(world.parameters().active);
    const bool repairs = draws_.chance(0.2);
    for (std::uint32_t i = 0; repairs && i < sent_count; ++i) {
        set.mutable_genes()->Add(bounds.min.begin(), bounds.min.end());
    }
    return sent;
}

v1::Request RandomCommands::reset(const Entry& entry) {
    v1::Request sent = request();
    sent.mutable_reset_world()->set_world(entry.name);
    if (draws_.chance(0.5)) {
        sent.mutable_reset_world()->set_seed(draws_.below(1000));
    }
    return sent;
}

v1::Request RandomCommands::fork(const Entry& entry, const Memory& memory) {
    v1::Request sent = request();
    sent.mutable_fork_world()->set_world(entry.name);
    sent.mutable_fork_world()->set_name(unused_name());
    if (const auto generation = forkable_generation(memory, draws_)) {
        sent.mutable_fork_world()->set_at_generation(*generation);
    }
    return sent;
}

std::optional<std::uint64_t> forkable_generation(const Memory& memory, Draws& draws) {
    if (memory.openings.empty() || draws.chance(0.4)) {
        return std::nullopt;
    }
    return draws.chance(0.4) ? memory.openings.rbegin()->first : draws.one_of(memory.openings).first;
}

} // namespace evod::histories
