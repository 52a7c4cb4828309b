// A command on its way through the server, as data: CommandMail on the way to the simulation thread, CommandDone on the
// way back.
//
// Way          network thread → mailbox → simulation thread (applies it and makes the answer) → storage thread (writes
//              the journal, if runs are stored) → outbox → Dispatcher::on_done() on the network thread.
// Threads      plain data; one thread at a time has it.
#pragma once

#include "evod/v1/stream.pb.h"
#include "server/base/result.h"
#include "server/run_file/records.h"
#include "server/simulation/commands.h"
#include "server/simulation/laboratory.h"

#include <cstdint>
#include <optional>
#include <string>

namespace evod::runtime {

struct CommandMail {
    simulation::Command command;
    run_file::Origin origin;
    std::string request_name;  // the field of the request: "set_parameters"
    std::uint64_t session = 0; // number of the sender's session; 0: the server itself
};

struct CommandDone {
    CommandMail mail; // the command names its world explicitly
    base::Result<simulation::Applied> outcome;
    std::string frame;                       // the encoded answer, as the journal stores it
    std::optional<std::uint64_t> lease = {}; // the lease of the world after the command; nullopt: it has none
    std::optional<v1::Event> event = {};     // for subscribers; nullopt: no change, or no subscriber
};

} // namespace evod::runtime
