// Events: converts events of the laboratory, of commands, and of the disk into messages.
#pragma once

#include "evod/v1/stream.pb.h"
#include "server/simulation/events.h"
#include "server/simulation/laboratory.h"

#include <optional>

namespace evod::protocol {

/// Converts an event. `laboratory` must be in its state right after the event.
v1::Event to_proto(const simulation::Event& event, const simulation::Laboratory& laboratory);

/// Returns the event that reports an applied command to subscribers; nullopt for a dry run.
///
/// by  the sender.
std::optional<v1::Event> event_of(const simulation::Command& command, const simulation::Applied& applied,
                                  const base::Actor& by, const simulation::Laboratory& laboratory);

/// Returns the event that reports a change of what decides when a world advances.
v1::Event run_control_event(const simulation::Entry& entry, const base::Actor& by);

/// Returns the event that reports a world that has stopped, because its run file is damaged.
v1::Event event_of(const simulation::DamagedWorld& damaged);

/// Returns the event that reports a new state of the disk.
///
/// world  the only world that the state concerns; empty: all worlds.
v1::Event event_of(const simulation::Storage& storage, const std::string& world = {});

} // namespace evod::protocol
