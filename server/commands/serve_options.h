// Serve options: the options of `evod` and `evod replay`, and the server that they describe.
//
// Threads  one.
#pragma once

#include "server/commands/common_options.h"
#include "server/network/server.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace evod::command_line {
class Command;
}

namespace evod::commands {

/// The variables that the options write. The defaults are those of the program.
struct ServeOptions {
    std::string bind_address = "127.0.0.1", http_bind_address = "127.0.0.1";
    std::uint16_t port = codec::default_port;
    std::optional<std::uint16_t> http_port;
    std::string log_level = "info", log_format = "text";
    std::size_t threads = default_thread_count();
    std::string experiment_file, population_file;
    std::optional<std::uint64_t> seed;
    std::string speed; // parse_speed() accepts it; empty: the default
    bool start = false;
    std::string data_folder;
    bool keep_nothing = false;
    bool token_needed = false;
    network::SessionBounds session_bounds;
    access::TlsFiles tls;
    std::string durability = "full";
    std::int64_t file_bytes_max = run_file::RunFile::Options{}.file_bytes_max;
    std::uint64_t keep_every = run_file::RunFile::Options{}.keep_every;
};

/// Addresses, access, TLS, metrics and log: the options of `evod` and of `evod replay`.
void add_server_options(command_line::Command& command, ServeOptions& options);
/// The options of `evod` alone.
void add_first_world_options(command_line::Command& command, ServeOptions& options);
void add_storage_options(command_line::Command& command, ServeOptions& options);

/// "max", or simulated seconds per second. Returns nothing for another text.
std::optional<simulation::Speed> parse_speed(const std::string& text);

/// The server of `evod`. Reads the experiment and the population that the options name, and draws what they leave open.
base::Result<network::ServerOptions> server_options(const ServeOptions& options);
/// The server of `evod replay`.
network::ServerOptions replay_server_options(const ServeOptions& options, network::ServerOptions::Replay run);

} // namespace evod::commands
