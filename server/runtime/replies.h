// Replies: what the simulation thread computes for its mail (mail.h), as data on the way to the network thread, where
// Dispatcher::on_done() completes the answer to the client.
//
// A reply with a ticket waits for the disk: the network thread holds it until the storage thread has given the receipt
// with this ticket (unwritten_replies.h).
//
// Threads      plain data; one thread at a time owns it.
#pragma once

#include "evod/v1/commands.pb.h"
#include "evod/v1/stream.pb.h"
#include "server/base/result.h"
#include "server/base/state_hash.h"
#include "server/protocol/queries.h"
#include "server/recording/receipt.h"
#include "server/runtime/mail.h"
#include "server/simulation/laboratory.h"

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace evod::runtime {

/// The file of a new fork. It must be read back before the client is answered.
struct ForkFile {
    std::vector<std::string> paths; // where the file is, also after the run has ended
    simulation::RunId run_id;
    base::StateHash hash; // of the fork at its beginning
};

struct CommandDone {
    CommandMail mail; // its command names the world explicitly
    base::Result<simulation::Applied> outcome;
    std::string frame;                       // the encoded answer, as the journal stores it
    std::optional<std::uint64_t> lease = {}; // lease of the world after the command; nullopt: no lease
    std::optional<v1::Event> event = {}; // event for subscribers; nullopt: nothing changed, or there is no subscriber
    recording::Ticket ticket = 0;
    std::optional<ForkFile> fork = {}; // nullopt: the command has created no fork, or its file is read back
};

struct QueryDone {
    QueryMail mail;
    v1::Response response;
    protocol::QueryResult result; // what the network thread adds to the response, or applies the request to
};

struct ReplayDone {
    ReplayMail mail;
    base::Result<std::string> world;         // the name of the replay, which shows the requested moment
    std::optional<v1::WorldInfo> shown = {}; // nullopt: the request was refused, or the replay is closed
};

struct FoundRun {
    replay::StoredRun run;
    std::uint64_t generation = 0; // generation of the world when the request was handled
};
struct RunFound {
    FindRun mail;
    base::Result<FoundRun> run;
    recording::Ticket ticket = 0;
};

/// Turns the answer to an applied command into a refusal. The command has changed the world but was not recorded, or the
/// record cannot be read.
CommandDone refused(CommandDone done, base::Refusal why);

/// What the network thread answers.
using Answer = std::variant<CommandDone, QueryDone, ReplayDone, RunFound>;
using Reply = std::variant<CommandDone, QueryDone, ReplayDone, RunFound, recording::Receipt>;

} // namespace evod::runtime
