// Server options: what a server starts with. Options that must be given together are one struct, options that exclude
// each other are a variant, and an option that may be absent is an std::optional.
//
// Threads      any; plain data.
#pragma once

#include "proto/codec/framing.h"
#include "server/access/tls.h"
#include "server/network/limits.h"
#include "server/recording/disk_state.h"
#include "server/run_file/run_file.h"
#include "server/runtime/processes.h"
#include "server/simulation/commands.h"
#include "server/simulation/islands.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace evod::network {

struct HttpOptions {
    std::string bind_address = "127.0.0.1";
    std::uint16_t port = 0; // 0: any free port
    // Names by which browsers may address the server, besides its own: of a proxy, of a DNS entry. If there is one,
    // every client needs a token: behind a proxy on the same machine all clients have a loopback address.
    std::vector<std::string> host_names = {};
    std::vector<std::string> embedders = {}; // origins whose pages may show the page in a frame
};

/// Where clients connect, and which clients the server admits.
struct ListenerOptions {
    std::string bind_address = "127.0.0.1";
    std::uint16_t port = codec::default_port;     // 0: any free port
    std::optional<HttpOptions> http = {};         // nullopt: no browser viewer and no metrics over HTTP
    std::optional<access::TlsFiles> tls = {};     // for both ports; nullopt: no TLS
    std::optional<std::string> token_folder = {}; // folder of the token file; nullopt: there are no tokens
    bool token_needed = false; // require a token on the loopback interface, too; other interfaces always require one
};

/// Whether the server refuses clients without a token, on all interfaces.
bool needs_token(const ListenerOptions& listeners);

/// The world with which a server begins. It is created unless it, or in the case of Requested::Nothing any world, is
/// already stored.
struct FirstWorldOptions {
    enum class Requested {
        Nothing,      // the user did not describe the world
        World,        // a stored world of this name must be equal, except for its seed
        WorldAndSeed, // a stored world of this name must be equal
    };
    simulation::CreateWorld world; // without run_id, which the dispatcher draws
    Requested requested = Requested::Nothing;
};

/// Commands that the server itself gives before any client. They apply to the first world if the user requested that
/// world; otherwise to the only world, or to the one with the name of the first world if there are several.
struct FirstCommands {
    std::optional<simulation::Speed> speed; // nullopt: the speed stays as it is
    bool run = false;                       // run the world without a goal

    bool is_empty() const { return !speed && !run; }
};

struct StorageOptions {
    std::string folder;
    run_file::RunFile::Options run_files;
    recording::StorageLimits limits = {};
};

/// The processes that simulate worlds together; this is the one with rank 0.
struct SharingProcesses {
    std::reference_wrapper<const runtime::Processes> all;
    std::reference_wrapper<simulation::IslandsMaker> islands_maker;
};

struct LiveWorlds {
    FirstWorldOptions first_world;
    FirstCommands first_commands;
    std::optional<StorageOptions> storage;     // nullopt: runs are not stored
    std::optional<SharingProcesses> processes; // nullopt: this process simulates all islands
};

/// A run file that the server shows as a replay.
struct ReplayedRun {
    std::string path;
    std::optional<std::uint64_t> generation; // generation to show first; nullopt: the first
};

/// What can change while a server runs.
struct ChangeableOptions {
    std::optional<access::TlsFiles> tls = {}; // used only if the server has started with TLS
    recording::StorageLimits storage = {};
};

struct ServerOptions {
    std::variant<LiveWorlds, ReplayedRun> worlds;
    ListenerOptions listeners;
    LimitOptions limits;
    std::size_t threads = 1; // number of threads in the worker pool
    // Reads the configuration again after SIGHUP; nullopt: it is invalid, and nothing changes. Logs what it finds.
    std::function<std::optional<ChangeableOptions>()> reread = {};
};

} // namespace evod::network
