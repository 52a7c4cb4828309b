// Mail: the entries of the mailbox, as data: commands, queries and requests for replays on their way to the simulation
// thread. replies.h contains the ways back.
//
// Way          network thread → mailbox → simulation thread, which computes the reply → outbox → Dispatcher::deliver()
//              on the network thread. Replies to commands go through the storage thread first, if runs are stored: it
//              writes the journal.
// Threads      plain data; one thread at a time owns it. A v1::Request is shared, and constant.
#pragma once

#include "server/replay/stored_run.h"
#include "server/run_file/records.h"
#include "server/simulation/commands.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>

namespace evod::v1 {
class Request;
}

namespace evod::runtime {

struct CommandMail {
    simulation::Command command;
    run_file::Origin origin;
    std::string request_name;  // name of the field in the request: "set_parameters"
    std::uint64_t session = 0; // number of the sender's session; 0: the server itself
};

/// A query that reads the laboratory. The simulation thread answers it between two ticks, when the query budget allows
/// it. Commands do not wait for queries, so a session passes on no further requests until its query is answered.
struct QueryMail {
    std::uint64_t session = 0; // number of the sender's session
    std::shared_ptr<const v1::Request> request;
    bool users_only = false; // the answer must not contain the programs and addresses of other clients
};

/// A request to find the stored run of the world that the request names. The reply waits until everything recorded so
/// far is on the disk, or until writing fails.
struct FindRun {
    std::uint64_t session = 0; // number of the sender's session
    std::shared_ptr<const v1::Request> request;
};

// Requests for replays (replays.h).

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
    std::uint64_t request_id = 0;
    std::string request_name = {}; // name of the field in the request: "open_replay"
};

/// A session has ended. Its query is dropped, its replays are closed and its seeks are cancelled.
struct SessionEnded {
    std::uint64_t session = 0;
};

/// Asks whether the simulation thread responds, which it does with a Pong (replies.h).
struct Ping {};

/// A short function that another part of the server runs on the simulation thread, such as the end of a background job.
struct CallMail {
    std::function<void()> call;
};

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

using Mail = std::variant<CommandMail, QueryMail, FindRun, ReplayMail, SessionEnded, Ping, CallMail, WorldBuilt>;

} // namespace evod::runtime
