#include "server/protocol/events.h"

#include "server/base/overloaded.h"
#include "server/protocol/actors.h"
#include "server/protocol/entities.h"
#include "server/protocol/parameters.h"
#include "server/protocol/ratings.h"
#include "server/protocol/refusals.h"
#include "server/protocol/worlds.h"

#include <string>

namespace evod::protocol {

using base::Overloaded;

v1::Event to_proto(const simulation::Event& event, const simulation::Laboratory& laboratory) {
    v1::Event message;
    message.set_world(event.world);
    message.set_run_id(to_text(event.run_id));
    message.set_tick(event.tick);
    std::visit(Overloaded{
                   [&](const simulation::GenerationFinished& finished) {
                       auto& to = *message.mutable_generation_finished();
                       for (const auto& statistics : finished.statistics) {
                           *to.add_statistics() = to_proto(statistics);
                       }
                   },
                   [&](const simulation::FitnessAwaited& awaited) {
                       auto& to = *message.mutable_fitness_awaited();
                       to.set_generation(awaited.generation);
                       if (const auto entry = laboratory.find(event.world)) {
                           add_awaited_islands((*entry)->world, *to.mutable_islands());
                       }
                   },
                   [&](const simulation::MigrationHappened& migration) {
                       auto& to = *message.mutable_migration();
                       to.set_generation(migration.generation);
                       for (const auto& edge : migration.edges) {
                           auto& to_edge = *to.add_edges();
                           to_edge.set_from_island(edge.from);
                           to_edge.set_to_island(edge.to);
                           to_edge.set_migrant_count(edge.migrant_count);
                       }
                   },
                   [&](const simulation::Extinction& extinction) {
                       auto& to = *message.mutable_extinction();
                       to.set_island(extinction.island);
                       to.set_generation(extinction.generation);
                   },
                   [&](const simulation::RunTerminated& terminated) {
                       message.mutable_run_terminated()->set_outcome(to_proto(terminated.outcome));
                   },
                   [&](const simulation::ParametersChanged& changed) {
                       auto& to = *message.mutable_parameters_changed();
                       *to.mutable_by() = to_proto(changed.by);
                       to.set_revision(changed.revision);
                       to.set_planned_change(changed.planned);
                       if (const auto entry = laboratory.find(event.world)) {
                           for (const std::string& name : changed.names) {
                               *to.add_changed() = state_of(*parameters::find_parameter(name),
                                                            (*entry)->world.parameters(), laboratory.class_of(**entry));
                           }
                       }
                   },
                   [&](const simulation::ChangeDropped& dropped) {
                       auto& to = *message.mutable_change_dropped();
                       *to.mutable_by() = to_proto(dropped.by);
                       to.set_planned_change(dropped.planned);
                       to.mutable_name()->Assign(dropped.names.begin(), dropped.names.end());
                       *to.mutable_violations() = to_proto(base::Refusal{.code = base::RefusalCode::InvalidArgument,
                                                                         .message = {},
                                                                         .violations = dropped.violations})
                                                      .violations();
                   },
                   [&](const simulation::GoalReached&) {
                       auto& to = *message.mutable_run_control_changed();
                       *to.mutable_by() = actor_of_kind(v1::ACTOR_KIND_GOAL);
                       if (const auto entry = laboratory.find(event.world)) {
                           *to.mutable_world() = to_proto(**entry);
                       }
                   },
               },
               event.kind);
    return message;
}

std::optional<v1::Event> event_of(const simulation::Command& command, const simulation::Applied& applied,
                                  const base::Actor& by, const simulation::Laboratory& laboratory) {
    v1::Event message;
    message.set_world(applied.world);
    message.set_tick(applied.tick);
    const auto entry = laboratory.find(applied.world);
    if (entry) {
        message.set_run_id(to_text((*entry)->run_id));
    }
    const auto set_world = [&](auto& to) {
        *to.mutable_by() = to_proto(by);
        if (entry) {
            *to.mutable_world() = to_proto(**entry);
        }
    };
    std::visit(
        Overloaded{
            [&](const simulation::CreateWorld&) { set_world(*message.mutable_world_created()); },
            [&](const simulation::ForkWorld&) { set_world(*message.mutable_world_created()); },
            [&](const simulation::ResetWorld&) { set_world(*message.mutable_world_reset()); },
            [&](const simulation::DeleteWorld&) { *message.mutable_world_deleted()->mutable_by() = to_proto(by); },
            [&](const simulation::SetParameters& set) {
                if (set.dry_run) {
                    return;
                }
                if (applied.planned) {
                    *message.mutable_change_planned()->mutable_change() = to_proto(*applied.planned);
                    return;
                }
                if (!applied.parameters) {
                    return;
                }
                auto& to = *message.mutable_parameters_changed();
                *to.mutable_by() = to_proto(by);
                to.set_revision(applied.parameters->revision);
                for (const auto& assignment : set.assignments) {
                    if (const auto* description = parameters::find_parameter(assignment.name)) {
                        *to.add_changed() =
                            state_of(*description, *applied.parameters, entry ? laboratory.class_of(**entry) : nullptr);
                    }
                }
            },
            [&](const simulation::CancelChange&) {
                auto& to = *message.mutable_change_cancelled();
                *to.mutable_by() = to_proto(by);
                if (applied.planned) {
                    *to.mutable_change() = to_proto(*applied.planned);
                }
            },
            [&](const simulation::PlaceEntities&) {
                *message.mutable_placed() = placed_message(*applied.placed);
                *message.mutable_placed()->mutable_by() = to_proto(by);
            },
            [&](const simulation::RemoveEntities&) {
                *message.mutable_removed() = removed_message(*applied.removed);
                *message.mutable_removed()->mutable_by() = to_proto(by);
            },
            [&](const simulation::SetFitness& set) {
                auto& to = *message.mutable_fitness_set();
                *to.mutable_by() = to_proto(by);
                to.set_generation(set.generation);
                to.set_island(set.island);
                to.set_organism_count(static_cast<std::uint32_t>(set.fitness.size()));
                if (entry) {
                    to.set_organism_count(to.organism_count() / (*entry)->world.parameters().active.objectives);
                    add_awaited_islands((*entry)->world, *to.mutable_awaited_islands());
                }
            },
            [&](const simulation::AddNote& note) {
                auto& to = *message.mutable_note_added();
                *to.mutable_by() = to_proto(by);
                to.set_kind(note.kind);
                to.set_text(note.text);
            },
            [&](const auto&) { set_world(*message.mutable_run_control_changed()); },
        },
        command);
    if (message.kind_case() == v1::Event::KIND_NOT_SET) {
        return std::nullopt;
    }
    return message;
}

v1::Event run_control_event(const simulation::Entry& entry, const base::Actor& by) {
    v1::Event message;
    message.set_world(entry.name);
    message.set_run_id(to_text(entry.run_id));
    message.set_tick(entry.world.moment().tick);
    auto& to = *message.mutable_run_control_changed();
    *to.mutable_by() = to_proto(by);
    *to.mutable_world() = to_proto(entry);
    return message;
}

v1::Event event_of(const simulation::DamagedWorld& damaged) {
    v1::Event message;
    message.set_world(damaged.name);
    if (damaged.run_id) {
        message.set_run_id(to_text(*damaged.run_id));
    }
    *message.mutable_world_damaged()->mutable_reason() = to_proto(damaged).reason();
    return message;
}

v1::Event event_of(const simulation::Storage& storage, const std::string& world) {
    v1::Event message;
    message.set_world(world);
    *message.mutable_storage_changed()->mutable_storage() = to_proto(storage);
    return message;
}

} // namespace evod::protocol
