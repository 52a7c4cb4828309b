// Serve options: the options of `evod` and `evod replay`, and the configuration of the server that they describe.
//
// Threads  one.
#pragma once

#include "server/commands/common_options.h"
#include "server/commands/shared_worlds.h"
#include "server/network/server_options.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace evod::command_line {
class Command;
}

namespace evod::commands {

constexpr std::uint16_t page_port = 7745; // of --web

/// The values of the options. Their initial values are the defaults of the program.
struct ServeOptions {
    std::string bind_address = "127.0.0.1", http_bind_address = "127.0.0.1";
    std::uint16_t port = codec::default_port;
    bool web = false;
    std::optional<std::uint16_t> http_port;
    std::vector<std::string> http_host_names, embedders;
    std::string log_level = "info", log_format = "text";
    SharingOptions sharing;
    std::string experiment_file, population_file;
    std::optional<std::uint64_t> seed;
    std::string speed; // a text that parse_speed() accepts; empty: the speed of the world stays
    bool start = false;
    std::string data_folder;
    bool keep_nothing = false;
    bool token_needed = false;
    network::LimitOptions limits;
    struct Tls { // files; empty: the option was not given
        std::string certificate, key, client_ca;
    } tls;
    std::string durability = "full";
    std::int64_t file_bytes_max = run_file::RunFile::Options{}.file_bytes_max;
    recording::StorageLimits storage;
    std::uint64_t keep_every = run_file::RunFile::Options{}.keep_every;
};

/// Adds the options of both `evod` and `evod replay`: addresses, access, TLS, metrics and log.
void add_server_options(command_line::Command& command, ServeOptions& options);
/// Adds all options of `evod`, and --config.
void add_all_options(command_line::Command& command, ServeOptions& options);

/// Parses "max", or a number of simulated seconds per second. Returns nullopt for any other text.
std::optional<simulation::Speed> parse_speed(const std::string& text);

/// Returns the files of the TLS options; nullopt if they are not given.
base::Result<std::optional<access::TlsFiles>> tls_files(const ServeOptions::Tls& tls);

/// Returns the configuration of the server for `evod`. Reads the experiment and the population that the options name.
/// If neither the options nor the experiment contain a seed, draws one at random.
///
/// processes  the processes that share the worlds; nullopt: only this one.
base::Result<network::ServerOptions> server_options(const ServeOptions& options,
                                                    std::optional<network::SharingProcesses> processes = {});
/// Returns the configuration of the server for `evod replay`.
base::Result<network::ServerOptions> replay_server_options(const ServeOptions& options, network::ReplayedRun run);

} // namespace evod::commands
