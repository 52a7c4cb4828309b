// Commands in the server, as data: CommandMail on its way to the simulation thread, CommandDone on its way back.
//
// Way          network thread → mailbox → simulation thread (applies the command and encodes the answer) → storage
//              thread (writes the journal, if runs are stored) → outbox → Dispatcher::on_done() on the network thread.
// Threads      plain data; one thread at a time owns it.
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
    std::string request_name;  // name of the field in the request: "set_parameters"
    std::uint64_t session = 0; // number of the sender's session; 0: the server itself
};

struct CommandDone {
    CommandMail mail; // its command names the world explicitly
    base::Result<simulation::Applied> outcome;
    std::string frame;                       // the encoded answer, as the journal stores it
    std::optional<std::uint64_t> lease = {}; // lease of the world after the command; nullopt: no lease
    std::optional<v1::Event> event = {}; // event for subscribers; nullopt: nothing changed, or there is no subscriber
};

} // namespace evod::runtime
