// Replies: what the simulation thread computes for its mail (mail.h), and what background jobs compute, as data on the
// way to the network thread, where Dispatcher::deliver() completes the answer to the client.
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

/// The worlds for which the commands of a ForEachWorld follow.
struct BatchBegun {
    std::uint64_t batch = 0;
    std::vector<std::string> worlds; // in order of creation
};

/// The rules of a class hold now.
struct ClassSet {
    std::uint64_t number = 0;
    std::vector<v1::Event> events = {};    // of the worlds that are frozen, or go on
    std::vector<std::string> worlds = {};  // all worlds of the class, with the forks
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

/// The memory of all replays and seeks of a session, after it has changed.
struct ReplayMemory {
    std::uint64_t session = 0;
    std::size_t bytes = 0;
};

/// A replay that has lost its place is closed. No snapshot or event of it follows.
struct ReplayEnded {
    std::string name;
};

/// Why a replay was closed, or is not opened, for another user.
base::Refusal replay_taken_back();

struct RunFound {
    FindRun mail;
    base::Result<FoundRun> run; // a fork is answered at once if there is none
    recording::Ticket ticket = 0;
};

/// The reply to a Ping.
struct Pong {};

// Results of background jobs (network/background_queries.h).

struct ExportPart {
    std::string text;
    bool last = false; // this is the last part of the table
    // In tables of organisms or lineage: the number of generations that are missing
    // (replay::generations_out_of_reach()).
    std::uint64_t generations_left_out = 0;
};
/// A request for the next part of an export.
struct PartRequest {
    std::uint64_t session = 0; // number of the sender's session
    std::uint64_t request_id = 0;
    std::uint64_t export_id = 0;
};
struct ExportPartDone {
    PartRequest request;
    base::Result<ExportPart> part;
};

/// The answer to GetBreeding.
struct BreedingDone {
    std::uint64_t query = 0; // number of the background query
    v1::Response response;
    bool is_shortened = false; // the answer omits rows because of a limit
};

/// Turns the answer to an applied command into a refusal. The command has changed the world but was not recorded, or
/// the record cannot be read.
CommandDone refused(CommandDone done, base::Refusal why);

/// What the network thread answers.
using Answer = std::variant<CommandDone, BatchBegun, ClassSet, QueryDone, ReplayDone, ReplayMemory, ReplayEnded,
                            RunFound, Pong, ExportPartDone, BreedingDone>;
/// What the outbox contains. ForkWorldComputed is on its way to the thread of the live worlds (simulations.h).
using Reply = std::variant<CommandDone, BatchBegun, ClassSet, QueryDone, ReplayDone, ReplayMemory, ReplayEnded,
                           RunFound, Pong, ExportPartDone, BreedingDone, ForkWorldComputed, recording::Receipt>;

} // namespace evod::runtime
