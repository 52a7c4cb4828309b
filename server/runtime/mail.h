// Mail: the entries of the mailbox, as data: commands, queries and requests for replays on their way to the simulation
// thread. replies.h contains the ways back.
//
// Way          network thread → mailbox → simulation thread, which computes the reply → outbox → Dispatcher::deliver()
//              on the network thread. If runs are stored, the reply to a command waits there for a receipt: the storage
//              thread writes the journal.
// Threads      plain data; one thread at a time owns it. A v1::Request is shared, and constant.
#pragma once

#include "server/access/authorization.h"
#include "server/recording/receipt.h"
#include "server/replay/stored_run.h"
#include "server/run_file/records.h"
#include "server/simulation/class_rules.h"
#include "server/simulation/commands.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace evod::runtime {

struct CommandMail {
    simulation::Command command;
    run_file::Origin origin;
    std::string request_name;  // name of the field in the request: "set_parameters"
    std::uint64_t session = 0; // number of the sender's session; 0: the server itself
    std::string user = {};     // whose quota pays
    access::Requester requester = {};
    const v1::RequestRules* rules =
        nullptr;             // of the request; nullptr: a command of the server itself, which may do everything
    std::uint64_t batch = 0; // number of the ForEachWorld to which the command belongs; 0: none
};

/// One command for every world of a class.
struct ForEachWorld {
    std::string class_name;
    std::shared_ptr<const v1::Request> request; // has for_each_world
    base::Actor by;
    std::uint64_t session = 0; // number of the sender's session
    std::string user = {};     // whose quota pays
    access::Requester requester = {};
    std::uint64_t batch = 0; // number of this request, >= 1
};

/// The rules of a class, after it was created, changed or deleted.
struct SetClass {
    std::string name;
    std::optional<simulation::ClassRules> rules; // nullopt: the class is deleted
    base::Actor by;
    std::uint64_t number = 0; // for the reply
};

/// A query that reads the laboratory. The simulation thread answers it between two ticks, when the query budget allows
/// it. Commands do not wait for queries, so a session passes on no further requests until its query is answered.
struct QueryMail {
    std::uint64_t session = 0; // number of the sender's session
    std::shared_ptr<const v1::Request> request;
    bool users_only = false; // the answer must not contain the programs and addresses of other clients
    std::string user = {};   // whose quota pays
};

/// The stored run of a world.
struct FoundRun {
    std::string world = {}; // whose run it is; of a replay: the original world
    replay::StoredRun run;
    simulation::Ownership ownership = {}; // of the world
    std::uint64_t generation = 0;         // generation of the world when the request was handled
    // The file reaches this moment once everything that was recorded is on the disk; zeros if that is not known.
    replay::RecordedUntil until = {};
};

// Requests for replays (replay_loop.h).

/// A request to open a replay of the run of the world `world`.
struct OpenReplay {
    std::string world;
    std::optional<replay::WantedMoment> at; // the moment to show at first; nullopt: the first moment of the run
};
/// A request to move a replay to another moment.
struct Seek {
    std::string world;
    replay::WantedMoment to;
};
struct CloseReplay {
    std::string world;
};
struct ReplayMail {
    std::variant<OpenReplay, Seek, CloseReplay> request;
    std::uint64_t session = 0; // number of the sender's session, >= 1
    std::string user = {};     // whose quota pays
    std::uint64_t request_id = 0;
    std::string request_name = {};    // name of the field in the request: "open_replay"
    std::optional<FoundRun> run = {}; // OpenReplay: the run to show. Seek: the present run of the original world
};

/// A request to find the stored run of a world. The reply waits until everything recorded so far is on the disk, or
/// until writing fails.
struct FindRun {
    std::string world;
    std::uint64_t session = 0; // number of the sender's session
    // What the run is for: a request of the session, a request for a replay, or a fork at an earlier generation.
    std::variant<std::shared_ptr<const v1::Request>, ReplayMail, CommandMail> purpose;
};

/// A request to the thread of the replays: the world of a live run at an earlier generation, to fork it.
struct ComputeForkWorld {
    CommandMail fork;
    FoundRun run; // where to find the generation
};
/// The thread of the replays has the command that forks one of them. Until the world comes, the commands that name the
/// fork must wait.
struct ForkAnnounced {
    std::string name;          // of the fork
    bool comes_at_once = true; // no seek is needed
};
/// The world of a fork, for the thread of the live worlds.
struct ForkWorldComputed {
    CommandMail fork;
    simulation::RunId run_id;                               // of the original
    std::shared_ptr<base::Result<simulation::World>> world; // moved out by the reader
};

/// A replay has lost its place to another user. It is closed; if it is still being opened, the request is refused.
struct EndReplay {
    std::uint64_t session = 0;    // number of the session that opens it
    std::uint64_t request_id = 0; // of the request that opens it
    std::string name = {};        // empty: it is being opened
};

/// A session has ended. Its query is dropped, its replays are closed and its seeks are cancelled.
struct SessionEnded {
    std::uint64_t session = 0;
};

/// Asks whether the simulation thread responds, which it does with a Pong (replies.h).
struct Ping {};

/// A world that was constructed for a command, before it is added to the laboratory.
struct BuiltWorld {
    simulation::World world;
    std::optional<run_file::RunBeginning> beginning; // for the run file; nullopt if runs are not stored
};
/// The build thread has constructed a world (world_builds.h).
struct WorldBuilt {
    std::uint64_t build = 0;
    std::shared_ptr<base::Result<BuiltWorld>> world; // nullptr: it has only read the original world so far
};

// The results of jobs that read run files for replays.

struct SeekRead {
    std::uint64_t seek = 0; // number of the seek
    std::shared_ptr<base::Result<replay::SeekStart>> start;
};
struct RecordsRead {
    std::string replay;
    std::shared_ptr<const base::Result<replay::NewRecords>> records;
};

using Mail =
    std::variant<CommandMail, ForEachWorld, SetClass, QueryMail, FindRun, ReplayMail, ComputeForkWorld, ForkAnnounced,
                 ForkWorldComputed, EndReplay, SessionEnded, Ping, WorldBuilt, SeekRead, RecordsRead>;

} // namespace evod::runtime
