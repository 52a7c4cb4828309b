// Events as messages: those of the laboratory, those that commands are, and news of the disk.
#pragma once

#include "evod/v1/stream.pb.h"
#include "server/simulation/events.h"
#include "server/simulation/laboratory.h"

#include <optional>
#include <string_view>

namespace evod::protocol {

/// laboratory  in which it has just happened.
v1::Event to_proto(const simulation::Event& event, const simulation::Laboratory& laboratory);

/// What to tell everyone of a command that was applied; nullopt for a dry run.
///
/// by  who sent it, as actor_of() takes it.
std::optional<v1::Event> event_of(const simulation::Command& command, const simulation::Applied& applied,
                                  std::string_view by, const simulation::Laboratory& laboratory);

/// It stands so with the disk from now on.
v1::Event event_of(const simulation::Storage& storage);

} // namespace evod::protocol
