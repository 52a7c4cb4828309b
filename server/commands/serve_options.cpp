#include "server/commands/serve_options.h"

#include "proto/command_line/command.h"
#include "server/commands/common_options.h"
#include "server/experiments/experiment_file.h"
#include "server/experiments/population_file.h"
#include "server/log/log.h"
#include "server/network/http_rules.h"
#include "server/runtime/random_ids.h"
#include "server/simulation/founders.h"

#include <boost/asio/ip/address_v6.hpp>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <string_view>
#include <utility>

namespace evod::commands {
namespace {

using command_line::Command;
using command_line::WholeNumber;

constexpr WholeNumber port_number{0, 65535};

void add_tls_options(Command& command, ServeOptions::Tls& tls) {
    command.add_option(
        "--tls-cert", &tls.certificate,
        "PEM file with the server's certificate, such as one from evod certificate; the server then accepts "
        "only TLS");
    command.add_option("--tls-key", &tls.key, "PEM file with the private key for --tls-cert");
    command.add_option(
        "--tls-client-ca", &tls.client_ca,
        "PEM file with CA certificates; every client then needs a certificate that one of these CAs has signed");
}

/// Allows what a browser sends as the host of an address, without port and brackets.
std::string host_name_problem(const std::string& word) {
    constexpr std::string_view other = "-._:";
    const auto is_part = [&](unsigned char character) {
        return std::isalnum(character) != 0 || other.find(static_cast<char>(character)) != std::string_view::npos;
    };
    boost::system::error_code not_an_address;
    boost::asio::ip::make_address_v6(word, not_an_address);
    const bool is_name = word.find(':') == std::string::npos && !word.empty() && std::ranges::all_of(word, is_part);
    const bool is_address = !not_an_address && word.find('%') == std::string::npos; // browsers send no IPv6 zone
    return is_name || is_address
               ? ""
               : "got " + word + ", allowed a host name without scheme and port, such as evod.example.org";
}

void add_http_options(Command& command, ServeOptions& options) {
    const auto web = command.add_flag("--web", &options.web,
                                      "Serve the page that shows the worlds in a browser, at TCP port " +
                                          std::to_string(page_port) + " or that of --http-port");
    const auto port = command
                          .add_option("--http-port", &options.http_port,
                                      "TCP port for the page, /metrics and /healthz over HTTP; 0: any free port; "
                                      "default: no HTTP without --web")
                          .check(port_number);
    const auto needs_http = [web, port](const std::string&) {
        return web.is_given() || port.is_given() ? std::string{} : std::string{"requires --web or --http-port"};
    };
    command.add_option("--http-bind", &options.http_bind_address, "IP address on which the server listens for HTTP")
        .check(needs_http)
        .show_default();
    command
        .add_option("--http-host", &options.http_host_names,
                    "Host name under which browsers reach this server, if it is neither the name nor an address of "
                    "this machine, for example the name of a proxy; every client then needs a token; may be repeated")
        .one_at_a_time()
        .check(needs_http)
        .check(host_name_problem);
    command
        .add_option("--embed-in", &options.embedders,
                    "Origin whose pages may show the page in a frame, such as http://localhost:8888 of Jupyter; may be "
                    "repeated")
        .one_at_a_time()
        .check(needs_http)
        .check(network::embedder_problem);
}

/// The configuration of the server for these worlds, or for the replay of this run.
base::Result<network::ServerOptions> serving(std::variant<network::LiveWorlds, network::ReplayedRun> worlds,
                                             const ServeOptions& options) {
    auto tls = tls_files(options.tls);
    if (!tls) {
        return tls.error();
    }
    network::ListenerOptions listeners{.bind_address = options.bind_address,
                                       .port = options.port,
                                       .http = {},
                                       .tls = *std::move(tls),
                                       .token_folder = data_folder_or_default(options.data_folder),
                                       .token_needed = options.token_needed};
    if (options.web || options.http_port) {
        listeners.http = {.bind_address = options.http_bind_address,
                          .port = options.http_port.value_or(page_port),
                          .host_names = options.http_host_names,
                          .embedders = options.embedders};
    }
    return network::ServerOptions{.worlds = std::move(worlds),
                                  .listeners = std::move(listeners),
                                  .limits = options.limits,
                                  .threads = options.sharing.threads.value_or(default_thread_count())};
}

base::Result<simulation::CreateWorld> first_world(const ServeOptions& options) {
    simulation::CreateWorld create{.name = "default", .parameters = {}, .seed = runtime::draw_seed(), .run_id = {}};
    if (!options.experiment_file.empty()) {
        const auto experiment = experiments::load_experiment(options.experiment_file);
        if (!experiment) {
            return experiment.error();
        }
        create.name = experiments::world_name(options.experiment_file);
        create.parameters = experiment->parameters;
        create.schedule = experiment->schedule;
        create.seed = experiment->seed.value_or(create.seed);
    }
    if (options.seed) {
        create.seed = base::Seed{*options.seed};
    }
    std::vector<std::string> files;
    if (!options.population_file.empty()) {
        files.push_back(options.population_file);
    }
    auto population = experiments::load_population(files, create.parameters);
    if (!population) {
        base::Refusal refused = population.error();
        refused.message = "--population: " + refused.message;
        return refused;
    }
    create.first_population = simulation::completed(*population, create.parameters, create.seed);
    return create;
}

void add_first_world_options(Command& command, ServeOptions& options) {
    command.option_group("First world");
    command.add_option("--experiment", &options.experiment_file,
                       "Experiment file (JSON) with the parameters of the first world");
    command
        .add_option("--seed", &options.seed,
                    "Seed of the first world; default: the seed of the experiment file, or a random one")
        .check(any_number);
    command.add_option(
        "--population", &options.population_file,
        "CSV file from `evod export --what population`; the first world begins with its organisms instead of "
        "random ones");
    command
        .add_option("--speed", &options.speed,
                    "Speed of the first or the restored world in simulated seconds per second, 0.001 to 10000, or max")
        .check([](const std::string& text) {
            return parse_speed(text) ? std::string{} : "got " + text + ", allowed max, or 0.001 to 10000";
        });
    command.add_flag("--start", &options.start, "Run the first or the restored world at once, without a goal");
}

void add_storage_options(Command& command, ServeOptions& options) {
    command.option_group("Storage");
    const auto data = command.add_option("--data", &options.data_folder,
                                         "Folder for run files and the token file; the server restores the worlds "
                                         "stored in it; default: $XDG_STATE_HOME/evod or ~/.local/state/evod");
    const auto keep_nothing =
        command
            .add_flag("--keep-nothing", &options.keep_nothing, "Do not store runs: they are lost when the server ends")
            .excludes(data);
    command
        .add_option("--durability", &options.durability,
                    "When the server answers a command. full: after the command was written to the disk; relaxed: "
                    "earlier, so that a power failure may lose the command, but a crash of evod does not")
        .choices({"full", "relaxed"})
        .excludes(keep_nothing)
        .show_default();
    command
        .add_option("--file-bytes-max", &options.file_bytes_max,
                    "Size of a run file in bytes above which evod stores fewer of the older generations in full; it "
                    "keeps the statistics of all generations, and can simulate them again")
        .check(WholeNumber{std::uint64_t{1} << 20, std::uint64_t{1} << 50})
        .excludes(keep_nothing)
        .show_default();
    command
        .add_option("--keep-every", &options.keep_every,
                    "In new run files, store the first, the last and every N-th generation in full; evod keeps the "
                    "statistics of all generations, and can simulate them again")
        .check(WholeNumber{1, 1'000'000'000})
        .excludes(keep_nothing)
        .show_default();
    command
        .add_option("--keep-runs", &options.storage.keep_runs,
                    "Keep only the newest N ended runs of each world, and delete older ones when a run ends; default: "
                    "all")
        .check(WholeNumber{0, 1'000'000'000})
        .excludes(keep_nothing);
    command
        .add_option("--disk-max", &options.storage.disk_bytes_max,
                    "Size of the data folder in bytes above which the server writes nothing, as if the disk were "
                    "full; default: the whole disk")
        .check(WholeNumber{std::uint64_t{1} << 20, std::uint64_t{1} << 60})
        .excludes(keep_nothing);
}

} // namespace

void add_server_options(Command& command, ServeOptions& options) {
    command.option_group("Listening");
    command
        .add_option("--bind", &options.bind_address, "IP address on which the server listens; 0.0.0.0: all interfaces")
        .show_default();
    command.add_option("--port", &options.port, "TCP port on which the server listens; 0: any free port")
        .check(port_number)
        .show_default();
    add_http_options(command, options);
    const auto add_limit = [&](const char* name, std::uint32_t& count, std::uint64_t least, const char* help) {
        command.add_option(name, &count, help).check(WholeNumber{least, 1'000'000}).show_default();
    };
    add_limit(
        "--sessions-max", options.limits.sessions_max, 2,
        "Maximum number of simultaneous sessions, each of which uses one file descriptor; a user may have half of "
        "them, without a token an address");
    add_limit("--worlds-max", options.limits.worlds_max, 1, "Maximum number of worlds, without replays");
    add_limit("--replays-max", options.limits.replays_max, 2,
              "Maximum number of simultaneous replays; a user may have half of them");
    command.option_group("Access and TLS");
    command.add_flag(
        "--require-token", &options.token_needed,
        "Require a token even if the server listens only on the loopback interface; on other interfaces the "
        "server always requires one");
    add_tls_options(command, options.tls);
    command.option_group("Log");
    command
        .add_option("--log-level", &options.log_level,
                    "Lowest level that is logged on standard error; debug adds every refusal, trace every request")
        .choices({log::level_names.begin(), log::level_names.end()})
        .show_default();
    command
        .add_option("--log-format", &options.log_format,
                    "Format of the log: text, or json with one JSON object per line")
        .choices({"text", "json"})
        .show_default();
}

void add_all_options(Command& command, ServeOptions& options) {
    command.add_options_file("--config",
                             "Configuration file: one option on a line, such as port = 7744; options of the command "
                             "line win; SIGHUP makes the server read it again");
    add_sharing_options(command, options.sharing);
    add_server_options(command, options);
    add_first_world_options(command, options);
    add_storage_options(command, options);
}

base::Result<std::optional<access::TlsFiles>> tls_files(const ServeOptions::Tls& tls) {
    const char* const missing = tls.certificate.empty() && !tls.key.empty()   ? "--tls-key requires --tls-cert"
                                : tls.key.empty() && !tls.certificate.empty() ? "--tls-cert requires --tls-key"
                                : tls.certificate.empty() && !tls.client_ca.empty()
                                    ? "--tls-client-ca requires --tls-cert and --tls-key"
                                    : nullptr;
    if (missing != nullptr) {
        return refusal(base::RefusalCode::FailedPrecondition, missing);
    }
    if (tls.certificate.empty()) {
        return std::nullopt;
    }
    return access::TlsFiles{.certificate = tls.certificate,
                            .key = tls.key,
                            .client_ca = tls.client_ca.empty() ? std::nullopt : std::optional{tls.client_ca}};
}

std::optional<simulation::Speed> parse_speed(const std::string& text) {
    if (text == "max") {
        return simulation::Speed{};
    }
    double factor = 0;
    const char* const end = text.data() + text.size();
    const auto [read_until, error] = std::from_chars(text.data(), end, factor);
    if (error != std::errc{} || read_until != end || !(factor >= simulation::speed_min) ||
        !(factor <= simulation::speed_max)) {
        return std::nullopt;
    }
    return simulation::Speed{factor};
}

base::Result<network::ServerOptions> server_options(const ServeOptions& options,
                                                    std::optional<network::SharingProcesses> processes) {
    using Requested = network::FirstWorldOptions::Requested;
    auto world = first_world(options);
    if (!world) {
        return world.error();
    }
    const bool is_described = !options.experiment_file.empty() || !options.population_file.empty();
    network::LiveWorlds worlds{
        .first_world = {.world = *std::move(world),
                        .requested = options.seed   ? Requested::WorldAndSeed
                                     : is_described ? Requested::World
                                                    : Requested::Nothing},
        .first_commands = {.speed = options.speed.empty() ? std::nullopt : parse_speed(options.speed),
                           .run = options.start},
        .storage = {},
        .processes = processes};
    if (!options.keep_nothing) {
        auto folder = data_folder_or_default(options.data_folder);
        if (!folder) {
            return refusal(base::RefusalCode::InvalidArgument,
                           std::string{no_data_folder} + ", or give --keep-nothing");
        }
        worlds.storage = {.folder = *std::move(folder),
                          .run_files = {.durability = options.durability == "relaxed" ? run_file::Durability::Relaxed
                                                                                      : run_file::Durability::Full,
                                        .vfs = nullptr,
                                        .file_bytes_max = options.file_bytes_max,
                                        .keep_every = options.keep_every},
                          .limits = options.storage};
    }
    return serving(std::move(worlds), options);
}

base::Result<network::ServerOptions> replay_server_options(const ServeOptions& options, network::ReplayedRun run) {
    return serving(std::move(run), options);
}

} // namespace evod::commands
