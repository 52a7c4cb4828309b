// evod: options → objects → run → exit code. The only place that knows everyone.
#include "proto/command_line/command.h"
#include "server/commands/certificate.h"
#include "server/commands/check.h"
#include "server/commands/common_options.h"
#include "server/commands/compare.h"
#include "server/commands/export.h"
#include "server/commands/fork.h"
#include "server/commands/parameter_list.h"
#include "server/commands/run.h"
#include "server/commands/sweep.h"
#include "server/commands/token.h"
#include "server/commands/verify.h"
#include "server/experiments/experiment_file.h"
#include "server/experiments/population_file.h"
#include "server/log/log.h"
#include "server/network/random_ids.h"
#include "server/network/server.h"
#include "server/parameters/experiment.h"
#include "server/protocol/refusals.h"

#include <google/protobuf/stubs/logging.h>

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <memory>
#include <new>
#include <system_error>
#include <thread>

namespace {

using namespace evod;
using command_line::Command;
using command_line::WholeNumber;

struct ServeOptions {
    std::string bind_address = "127.0.0.1", http_bind_address = "127.0.0.1";
    std::uint16_t port = codec::default_port;
    std::optional<std::uint16_t> http_port;
    std::string log_level = "info", log_format = "text";
    bool log_begun = false; // from then on, standard output is a log
    std::size_t threads = std::max(1u, std::thread::hardware_concurrency());
    std::string experiment_file, population_file;
    std::optional<std::uint64_t> seed;
    std::string speed;
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

/// Says why evod cannot start, and what to do.
int fail(const std::string& why) {
    std::cerr << "evod: " << why << '\n';
    return 1;
}

/// Whether standard output is a log, for end_of_exception().
std::atomic<bool> is_logging = false;

void begin_log(ServeOptions& options) {
    options.log_begun = is_logging = true;
    log::begin(log::level_named(options.log_level),
               options.log_format == "json" ? log::Format::Json : log::Format::Text);
}

/// Exit status of a program for which there was not enough memory.
constexpr int exit_out_of_memory = 3, exit_not_written = 4;

/// Given back before the last message is written, which needs some memory itself.
std::unique_ptr<char[]> memory_for_last_message;

/// The end of a program that an exception leaves. Memory that is not there is no fault of the program: what was
/// answered is on the disk, and the program can be started again.
[[noreturn]] void end_of_exception() {
    static std::atomic<std::thread::id> ending;
    std::thread::id nobody;
    if (!ending.compare_exchange_strong(nobody, std::this_thread::get_id())) {
        while (ending != std::this_thread::get_id()) {
            ::pause(); // another thread ends the program
        }
        static constexpr char text[] = "evod: out of memory\n"; // the last message had too little, too
        (void)!::write(STDERR_FILENO, text, sizeof text - 1);
        std::_Exit(exit_out_of_memory);
    }
    const char* what = nullptr;
    try {
        if (const auto error = std::current_exception()) {
            std::rethrow_exception(error);
        }
        std::abort();
    } catch (const std::bad_alloc&) {
        memory_for_last_message.reset();
        what = "out of memory";
    } catch (const std::system_error& error) {
        if (error.code() != std::errc::resource_unavailable_try_again && error.code() != std::errc::not_enough_memory) {
            std::cerr << "evod: " << error.what() << '\n';
            std::abort();
        }
        memory_for_last_message.reset();
        what = "out of memory, or of threads";
    } catch (const std::exception& error) {
        std::cerr << "evod: " << error.what() << '\n';
        std::abort();
    } catch (...) {
        std::abort();
    }
    if (is_logging) {
        log::error("{}: evod ends; runs go on where they were when it is started again", what);
    } else {
        std::cerr << "evod: " << what << '\n';
    }
    std::_Exit(exit_out_of_memory);
}

/// As many file descriptors as the system allows: what is usual, 1,024, is soon taken by connections.
void allow_descriptors() {
    rlimit limit{};
    if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) {
        return;
    }
    limit.rlim_cur = limit.rlim_max;
    ::setrlimit(RLIMIT_NOFILE, &limit);
}

/// Serves until it is told to end.
int serve(network::ServerOptions options) {
    allow_descriptors();
    const std::string folder = options.data_folder, first_world = options.first_world.name;
    const bool encrypted = !options.tls.certificate.empty();
    const std::string replay = options.replay ? ", replay of " + options.replay->path : "";
    const auto server = network::Server::open(std::move(options));
    if (!server) {
        return fail(to_text(server.error()));
    }
    if (!folder.empty()) {
        log::info("runs are kept in {}", folder);
    }
    const auto endpoint = (*server)->endpoint();
    if (!endpoint.address().is_loopback() && !encrypted) {
        log::warn("without TLS, whoever is on the way to {} can read tokens and take them: see --tls-cert",
                  endpoint.address().to_string());
    }
    if (const auto http = (*server)->http_endpoint()) {
        const std::string address = http->address().to_string();
        log::info("metrics and health at http://{}:{}/metrics and /healthz",
                  http->address().is_v6() ? "[" + address + "]" : address, http->port());
        if (!http->address().is_loopback()) {
            log::warn("whoever reaches {}:{} can read the metrics: there are no tokens for HTTP", address,
                      http->port());
        }
    }
    const auto seed = (*server)->first_seed();
    log::info("evod {} listening on {}:{}{}", EVOD_VERSION, endpoint.address().to_string(), endpoint.port(),
              seed ? ", world \"" + first_world + "\", seed " + std::to_string(seed->value) : replay);
    const bool all_written = (*server)->run();
    log::info("stopped");
    return all_written ? 0 : exit_not_written;
}

constexpr WholeNumber port_number{0, 65535};

/// Adds the options of every way to serve: addresses, access, TLS, metrics, log.
void add_common_options(Command& command, ServeOptions& options) {
    command.add_option("--bind", &options.bind_address, "Address to listen on; 0.0.0.0 is every interface")
        .show_default();
    command.add_option("--port", &options.port, "Port to listen on; 0 is any that is free")
        .check(port_number)
        .show_default();
    command.add_option("--threads", &options.threads, "Threads that simulate")
        .check(commands::thread_count)
        .show_default();
    const auto http = command
                          .add_option("--http-port", &options.http_port,
                                      "Port for /metrics and /healthz over HTTP, such as 7745; 0 is any that is free. "
                                      "Otherwise there are none")
                          .check(port_number);
    command.add_option("--http-bind", &options.http_bind_address, "Address to serve those on")
        .needs(http)
        .show_default();
    command
        .add_option("--log-level", &options.log_level,
                    "Least weight of what is logged: debug has every refusal, trace "
                    "every request")
        .choices({log::level_names.begin(), log::level_names.end()})
        .show_default();
    command.add_option("--log-format", &options.log_format, "text: sentences; json: an object a line")
        .choices({"text", "json"})
        .show_default();
    command.add_flag("--require-token", &options.token_needed,
                     "Let nobody in without a token, be it from this machine; from others it is always needed");
    command.add_option("--tls-cert", &options.tls.certificate,
                       "PEM file with the certificate: TLS only; see evod certificate");
    command.add_option("--tls-key", &options.tls.key, "PEM file with its key");
    command.add_option("--tls-client-ca", &options.tls.client_ca,
                       "PEM file: clients must show a certificate that one of these vouches for");
    const auto add_sessions = [&](const char* name, std::uint32_t& count, const char* help) {
        command.add_option(name, &count, help).check(WholeNumber{1, 1'000'000}).show_default();
    };
    add_sessions("--sessions-max", options.session_bounds.sessions_max,
                 "Sessions at a time; one more is told, and closed. Each takes a file descriptor");
    add_sessions("--sessions-per-address-max", options.session_bounds.sessions_per_address_max,
                 "The same, of one address; of IPv6, of one /64");
}

/// "max" or a factor of real time; nullopt: neither.
std::optional<simulation::Speed> parse_speed(const std::string& text) {
    if (text == "max") {
        return simulation::Speed{};
    }
    double factor = 0;
    const auto read = std::from_chars(text.data(), text.data() + text.size(), factor);
    if (read.ec != std::errc{} || read.ptr != text.data() + text.size() ||
        !(factor >= simulation::speed_min && factor <= simulation::speed_max)) {
        return std::nullopt;
    }
    return simulation::Speed{factor};
}

std::optional<network::ServerOptions::HttpOptions> http_options(const ServeOptions& options) {
    if (!options.http_port) {
        return std::nullopt;
    }
    return network::ServerOptions::HttpOptions{.bind_address = options.http_bind_address, .port = *options.http_port};
}

int serve(ServeOptions& options) {
    begin_log(options);
    simulation::CreateWorld create{
        .name = "default", .parameters = {}, .seed = network::draw_seed(), .run_id = network::draw_run_id()};
    if (!options.experiment_file.empty()) {
        const auto experiment = experiments::load_experiment(options.experiment_file);
        if (!experiment) {
            return fail(to_text(experiment.error()));
        }
        create.name = experiments::world_name(options.experiment_file);
        create.parameters = experiment->parameters;
        create.schedule = experiment->schedule;
        create.seed = experiment->seed.value_or(create.seed);
    }
    if (options.seed) {
        create.seed = base::Seed{*options.seed};
    }
    auto population = experiments::load_population(options.population_file, create.parameters);
    if (!population) {
        return fail("--population: " + to_text(population.error()));
    }
    create.first_population = *std::move(population);

    std::string data_folder = commands::data_folder_or_default(options.data_folder);
    if (options.keep_nothing) {
        data_folder.clear();
    } else if (data_folder.empty()) {
        return fail(std::string{commands::no_data_folder} + ", or give --keep-nothing");
    }
    network::ServerOptions server_options{
        .bind_address = options.bind_address,
        .port = options.port,
        .threads = options.threads,
        .data_folder = data_folder,
        .token_folder = commands::data_folder_or_default(options.data_folder),
        .session_bounds = options.session_bounds,
        .token_needed = options.token_needed,
        .tls = options.tls,
        .run_files = {.durability =
                          options.durability == "relaxed" ? run_file::Durability::Relaxed : run_file::Durability::Full,
                      .vfs = nullptr,
                      .file_bytes_max = options.file_bytes_max,
                      .keep_every = options.keep_every},
        .http = http_options(options),
        .replay = {},
        .first_world = std::move(create),
        .first_world_asked = !options.experiment_file.empty() || options.seed || !options.population_file.empty(),
        .first_seed_asked = options.seed.has_value(),
        .first_speed = {},
        .first_run = options.start};
    if (!options.speed.empty()) {
        server_options.first_speed = *parse_speed(options.speed);
    }

    return serve(std::move(server_options));
}

int replay(ServeOptions& options, network::ServerOptions::Replay run) {
    begin_log(options);
    return serve({.bind_address = options.bind_address,
                  .port = options.port,
                  .threads = options.threads,
                  .data_folder = {},
                  .token_folder = commands::data_folder_or_default(options.data_folder),
                  .session_bounds = options.session_bounds,
                  .token_needed = options.token_needed,
                  .tls = options.tls,
                  .run_files = {},
                  .http = http_options(options),
                  .replay = std::move(run),
                  .first_world = {},
                  .first_speed = {}});
}

void add_first_world_options(Command& app, ServeOptions& options) {
    app.add_option("--experiment", &options.experiment_file, "JSON file with the parameters of the first world");
    app.add_option("--seed", &options.seed, "Seed of the first world; otherwise the file's, or one drawn by chance")
        .check(commands::any_number);
    app.add_option(
        "--population", &options.population_file,
        "CSV file of `evod export --what population`: the first world begins with these organisms instead of "
        "drawn ones");
    app.add_option("--speed", &options.speed,
                   "Of the first world, or the one that is found: simulated seconds per second, "
                   "0.001 to 10000, or max")
        .check([](const std::string& text) {
            return parse_speed(text) ? std::string{} : "must be max, or a number from 0.001 to 10000, not " + text;
        });
    app.add_flag("--start", &options.start, "Run that world at once, without end");
}

void add_storage_options(Command& app, ServeOptions& options) {
    const auto data = app.add_option("--data", &options.data_folder,
                                     "Folder where runs are kept, a file each; worlds found there go on. Otherwise "
                                     "$XDG_STATE_HOME/evod, or ~/.local/state/evod");
    const auto keep_nothing =
        app.add_flag("--keep-nothing", &options.keep_nothing, "Keep no files: runs end with the server").excludes(data);
    app.add_option(
           "--durability", &options.durability,
           "When a command is answered. full: once it is on the disk; relaxed: before, so that it survives evod, "
           "but perhaps not the machine")
        .choices({"full", "relaxed"})
        .excludes(keep_nothing)
        .show_default();
    app.add_option(
           "--file-bytes-max", &options.file_bytes_max,
           "From this size on a run file holds fewer and fewer of its older generations whole; they can still be "
           "simulated again, and statistics are kept")
        .check(WholeNumber{std::uint64_t{1} << 20, std::uint64_t{1} << 50})
        .excludes(keep_nothing)
        .show_default();
    app.add_option("--keep-every", &options.keep_every,
                   "New run files hold each of so many generations whole, and the first and the last; the others can "
                   "still be simulated again, and statistics are kept")
        .check(WholeNumber{1, 1'000'000'000})
        .excludes(keep_nothing)
        .show_default();
}

void add_replay_command(Command& app, ServeOptions& options) {
    auto& command = app.add_command("replay", "Serve a run file: its past can be watched, and nothing changed");
    auto& run = command.keep(network::ServerOptions::Replay{});
    command.add_option("run", &run.path, "Run file, NAME.evod; the run need not be over").required();
    command.add_option("--generation", &run.generation, "Begins there; otherwise with the first")
        .check(commands::generation_number);
    command.add_option("--data", &options.data_folder, "Folder whose tokens let others in");
    add_common_options(command, options);
    command.footer("Watch it with evoview, go elsewhere in it with evoctl seek, run and pause it as any world.");
    command.action([&] { return replay(options, run); });
}

} // namespace

int main(int argument_count, char** arguments) {
    constexpr std::size_t last_message_bytes = 1 << 20;
    memory_for_last_message = std::make_unique<char[]>(last_message_bytes);
    std::set_terminate(end_of_exception);
    // A file that may not become larger (ulimit -f) is a disk that fails, and no reason to end.
    std::signal(SIGXFSZ, SIG_IGN);
    // The server reports a malformed message to its sender. Protocol Buffers would log each one besides, and any client
    // could fill the log.
    google::protobuf::SetLogHandler(nullptr);
    ServeOptions options;
    Command app{"evod", "An evolution laboratory that runs as a server.", "evod " EVOD_VERSION};
    add_common_options(app, options);
    add_first_world_options(app, options);
    add_storage_options(app, options);
    app.footer("Without a subcommand evod is a server.");
    app.hand_options_down("the server");
    app.action([&] { return serve(options); });
    const base::Seed drawn_seed = network::draw_seed();
    commands::add_run_command(app, options.threads, drawn_seed);
    commands::add_compare_command(app, options.threads, drawn_seed);
    commands::add_sweep_command(app, options.threads, network::draw_run_id);
    commands::add_check_command(app);
    commands::add_fork_command(app, network::draw_run_id);
    add_replay_command(app, options);
    commands::add_verify_command(app, options.threads);
    commands::add_export_command(app, options.threads);
    commands::add_token_command(app);
    commands::add_certificate_command(app);
    commands::add_parameters_command(app);
    app.add_command("limits", "Print every limit of the network, as docs/OPERATIONS.md has it").action([] {
        std::cout << network::limit_list();
    });

    const std::optional<int> ended = app.parse(argument_count, arguments);
    const int status = ended ? *ended : app.run();
    // A server keeps running where its log cannot be written.
    if (options.log_begun || (std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout.flush())) {
        return status;
    }
    const int failed = fail("standard output cannot be written: the disk may be full");
    return status == 0 ? failed : status;
}
