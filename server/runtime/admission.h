// Admission: whether the sender of a command may send it to this world, as the world is when the command's turn comes.
//
// Threads      a simulation thread.
#pragma once

#include "server/runtime/mail.h"
#include "server/simulation/laboratory.h"

#include <optional>

namespace evod::runtime {

/// Returns why the command is refused; nullopt if it is permitted. Gives the world of a CreateWorld or ForkWorld its
/// owner: the sender. A fork stays in the class of the original if the sender owns the original, or teaches the class.
///
/// world  that the command names; nullptr: it names none, or it is damaged.
std::optional<base::Refusal> admit(CommandMail& mail, const simulation::Entry* world);

} // namespace evod::runtime
