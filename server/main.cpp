// evod: options → objects → run → exit code. The only place that knows everyone.
#include "proto/wire/whole_number.h"
#include "server/access/certificate.h"
#include "server/console/check.h"
#include "server/console/compare.h"
#include "server/console/experiment_file.h"
#include "server/console/export.h"
#include "server/console/fork.h"
#include "server/console/parameter_list.h"
#include "server/console/population_file.h"
#include "server/console/run.h"
#include "server/console/sweep.h"
#include "server/console/token.h"
#include "server/console/verify.h"
#include "server/log/log.h"
#include "server/network/random_ids.h"
#include "server/network/server.h"
#include "server/protocol/refusals.h"
#include "server/simulation/experiment.h"

#include <CLI/CLI.hpp>
#include <google/protobuf/stubs/logging.h>

#include <sys/resource.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <limits>
#include <thread>

namespace {

using namespace evod;

struct ServeOptions {
    std::string bind_address = "127.0.0.1", http_bind_address = "127.0.0.1";
    std::uint16_t port = wire::default_port;
    std::optional<std::uint16_t> http_port;
    std::string log_level = "info", log_format = "text";
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
    std::int64_t file_bytes_max = storage::RunFile::Options{}.file_bytes_max;
    std::uint64_t keep_every = storage::RunFile::Options{}.keep_every;
};

/// Says why evod cannot start, and what to do.
int fail(const std::string& why) {
    std::cerr << "evod: " << why << '\n';
    return 1;
}

/// Where runs and tokens are kept: in the folder that was asked for; if none was, in the XDG Base Directory
/// Specification's place for what a user's programs remember. Empty if the environment names no such place.
std::string folder_of_runs(const std::string& asked) {
    if (!asked.empty())
        return asked;
    // A path that is not absolute is to be ignored.
    if (const char* state = std::getenv("XDG_STATE_HOME"); state != nullptr && *state == '/')
        return std::string{state} + "/evod";
    if (const char* home = std::getenv("HOME"); home != nullptr && *home == '/')
        return std::string{home} + "/.local/state/evod";
    return {};
}

const std::string no_folder = "neither XDG_STATE_HOME nor HOME says where runs are kept: name a folder with --data";

/// As many file descriptors as the system allows: what is usual, 1,024, is soon taken by connections.
void allow_descriptors() {
    rlimit limit{};
    if (::getrlimit(RLIMIT_NOFILE, &limit) != 0)
        return;
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
    if (!server)
        return fail(to_text(server.error()));
    if (!folder.empty())
        log::info("runs are kept in {}", folder);
    const auto endpoint = (*server)->endpoint();
    if (!endpoint.address().is_loopback() && !encrypted)
        log::warn("without TLS, whoever is on the way to {} can read tokens and take them: see --tls-cert",
                  endpoint.address().to_string());
    if (const auto http = (*server)->http_endpoint()) {
        const std::string address = http->address().to_string();
        log::info("metrics and health at http://{}:{}/metrics and /healthz",
                  http->address().is_v6() ? "[" + address + "]" : address, http->port());
        if (!http->address().is_loopback())
            log::warn("whoever reaches {}:{} can read the metrics: there are no tokens for HTTP", address,
                      http->port());
    }
    const auto seed = (*server)->first_seed();
    log::info("evod {} listening on {}:{}{}", EVOD_VERSION, endpoint.address().to_string(), endpoint.port(),
              seed ? ", world \"" + first_world + "\", seed " + std::to_string(seed->value) : replay);
    (*server)->run();
    log::info("stopped");
    return 0;
}

// Of options.
using wire::WholeNumber;
constexpr WholeNumber whole_number{}, thread_count{1, 1024}, port_number{0, 65535}, generation_number{.min = 1};

/// What is given before a subcommand counts as if it came after, if the subcommand knows it. What it has no use for
/// would do nothing, and is refused.
void hand_down(const CLI::App& app) {
    if (app.get_subcommands().empty())
        return;
    CLI::App* command = app.get_subcommands().front();
    std::string words = "evod " + command->get_name();
    while (!command->get_subcommands().empty()) {
        command = command->get_subcommands().front();
        words += " " + command->get_name();
    }
    for (const CLI::Option* given : app.get_options()) {
        if (given->count() == 0)
            continue;
        const std::string name = given->get_name();
        CLI::Option* own = command->get_option_no_throw(name);
        if (own == nullptr)
            throw CLI::ValidationError{name,
                                       "an option of the server, which " + words + " has no use for: leave it out"};
        if (own->count() > 0)
            throw CLI::ValidationError{name, "given twice, before " + command->get_name() + " and after it"};
        own->add_result(given->results());
        own->run_callback();
    }
}

/// Of who may come in, and how, and what the server says of itself: for every way to serve.
void add_common_options(CLI::App& app, ServeOptions& options) {
    app.add_option("--bind", options.bind_address, "Address to listen on; 0.0.0.0 is every interface")
        ->capture_default_str();
    app.add_option("--port", options.port, "Port to listen on; 0 is any that is free")
        ->check(port_number)
        ->capture_default_str();
    app.add_option("--threads", options.threads, "Threads that simulate")->check(thread_count)->capture_default_str();
    CLI::Option* http = app.add_option("--http-port", options.http_port,
                                       "Port for /metrics and /healthz over HTTP, such as 7745; 0 is any that is free. "
                                       "Otherwise there are none")
                            ->check(port_number);
    app.add_option("--http-bind", options.http_bind_address, "Address to serve those on")
        ->needs(http)
        ->capture_default_str();
    app.add_option("--log-level", options.log_level,
                   "Least weight of what is logged: debug has every refusal, trace "
                   "every request")
        ->check(CLI::IsMember(std::vector<std::string>{log::level_names.begin(), log::level_names.end()}))
        ->capture_default_str();
    app.add_option("--log-format", options.log_format, "text: sentences; json: an object a line")
        ->check(CLI::IsMember({"text", "json"}))
        ->capture_default_str();
    app.add_flag("--require-token", options.token_needed,
                 "Let nobody in without a token, be it from this machine; from others it is always needed");
    app.add_option("--tls-cert", options.tls.certificate,
                   "PEM file with the certificate: TLS only; see evod certificate");
    app.add_option("--tls-key", options.tls.key, "PEM file with its key");
    app.add_option("--tls-client-ca", options.tls.client_ca,
                   "PEM file: clients must show a certificate that one of these vouches for");
    const auto add_sessions = [&](const char* name, std::uint32_t& count, const char* help) {
        app.add_option(name, count, help)->check(WholeNumber{1, 1'000'000})->capture_default_str();
    };
    add_sessions("--sessions-max", options.session_bounds.sessions_max,
                 "Sessions at a time; one more is told, and closed. Each takes a file descriptor");
    add_sessions("--sessions-per-address-max", options.session_bounds.sessions_per_address_max,
                 "The same, of one address; of IPv6, of one /64");
}

/// "max" or a factor of real time; nullopt: neither.
std::optional<simulation::Speed> parse_speed(const std::string& text) {
    if (text == "max")
        return simulation::Speed{};
    double factor = 0;
    const auto read = std::from_chars(text.data(), text.data() + text.size(), factor);
    if (read.ec != std::errc{} || read.ptr != text.data() + text.size() ||
        !(factor >= simulation::speed_min && factor <= simulation::speed_max))
        return std::nullopt;
    return simulation::Speed{factor};
}

std::optional<network::ServerOptions::HttpOptions> http_options(const ServeOptions& options) {
    if (!options.http_port)
        return std::nullopt;
    return network::ServerOptions::HttpOptions{.bind_address = options.http_bind_address, .port = *options.http_port};
}

int serve(const ServeOptions& options) {
    simulation::CreateWorld create{
        .name = "default", .parameters = {}, .seed = network::draw_seed(), .run_id = network::draw_run_id()};
    if (!options.experiment_file.empty()) {
        const auto experiment = console::load_experiment(options.experiment_file);
        if (!experiment)
            return fail(to_text(experiment.error()));
        create.name = console::world_name(options.experiment_file);
        create.parameters = experiment->parameters;
        create.schedule = experiment->schedule;
        create.seed = experiment->seed.value_or(create.seed);
    }
    if (options.seed)
        create.seed = base::Seed{*options.seed};
    auto population = console::load_population(options.population_file, create.parameters);
    if (!population)
        return fail("--population: " + to_text(population.error()));
    create.first_population = *std::move(population);

    std::string data_folder = folder_of_runs(options.data_folder);
    if (options.keep_nothing)
        data_folder.clear();
    else if (data_folder.empty())
        return fail(no_folder + ", or give --keep-nothing");
    network::ServerOptions server_options{
        .bind_address = options.bind_address,
        .port = options.port,
        .threads = options.threads,
        .data_folder = data_folder,
        .token_folder = folder_of_runs(options.data_folder),
        .session_bounds = options.session_bounds,
        .token_needed = options.token_needed,
        .tls = options.tls,
        .run_files = {.durability =
                          options.durability == "relaxed" ? storage::Durability::Relaxed : storage::Durability::Full,
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
    if (!options.speed.empty())
        server_options.first_speed = *parse_speed(options.speed);

    return serve(std::move(server_options));
}

int replay(const ServeOptions& options, network::ServerOptions::Replay run) {
    return serve({.bind_address = options.bind_address,
                  .port = options.port,
                  .threads = options.threads,
                  .data_folder = {},
                  .token_folder = folder_of_runs(options.data_folder),
                  .session_bounds = options.session_bounds,
                  .token_needed = options.token_needed,
                  .tls = options.tls,
                  .run_files = {},
                  .http = http_options(options),
                  .replay = std::move(run),
                  .first_world = {},
                  .first_speed = {}});
}

/// Returns the exit status.
///
/// serves  becomes true before it is a server: what that says is a log, which nobody need read.
int perform(int argument_count, char** arguments, bool& serves) {
    // What is wrong with a message is told to whoever sent it. Protocol Buffers would write a line of its own for each,
    // and anybody could fill the log.
    google::protobuf::SetLogHandler(nullptr);
    ServeOptions options;
    CLI::App app{"An evolution laboratory that runs as a server.", "evod"};
    app.set_version_flag("--version", std::string{"evod "} + EVOD_VERSION);
    add_common_options(app, options);
    app.add_option("--experiment", options.experiment_file, "JSON file with the parameters of the first world");
    app.add_option("--seed", options.seed, "Seed of the first world; otherwise the file's, or one drawn by chance")
        ->check(whole_number);
    app.add_option(
        "--population", options.population_file,
        "CSV file of `evod export --what population`: the first world begins with these organisms instead of "
        "drawn ones");
    app.add_option("--speed", options.speed,
                   "Of the first world, or the one that is found: simulated seconds per second, "
                   "0.001 to 10000, or max")
        ->check([](const std::string& text) {
            return parse_speed(text) ? std::string{} : "must be max, or a number from 0.001 to 10000, not " + text;
        });
    app.add_flag("--start", options.start, "Run that world at once, without end");
    CLI::Option* data = app.add_option("--data", options.data_folder,
                                       "Folder where runs are kept, a file each; worlds found there go on. Otherwise "
                                       "$XDG_STATE_HOME/evod, or ~/.local/state/evod");
    CLI::Option* keep_nothing =
        app.add_flag("--keep-nothing", options.keep_nothing, "Keep no files: runs end with the server")->excludes(data);
    app.add_option(
           "--durability", options.durability,
           "When a command is answered. full: once it is on the disk; relaxed: before, so that it survives evod, "
           "but perhaps not the machine")
        ->check(CLI::IsMember({"full", "relaxed"}))
        ->excludes(keep_nothing)
        ->capture_default_str();
    app.add_option(
           "--file-bytes-max", options.file_bytes_max,
           "From this size on a run file holds fewer and fewer of its older generations whole; they can still be "
           "simulated again, and statistics are kept")
        ->check(WholeNumber{std::uint64_t{1} << 20, std::uint64_t{1} << 50})
        ->excludes(keep_nothing)
        ->capture_default_str();
    app.add_option("--keep-every", options.keep_every,
                   "New run files hold each of so many generations whole, and the first and the last; the others can "
                   "still be simulated again, and statistics are kept")
        ->check(WholeNumber{1, 1'000'000'000})
        ->excludes(keep_nothing)
        ->capture_default_str();
    app.footer("Without a subcommand evod is a server.");

    console::RunOptions run_options;
    run_options.threads = options.threads;
    run_options.drawn_seed = network::draw_seed();
    CLI::App& run = *app.add_subcommand("run", "Run an experiment without a network");
    run.add_option("experiment", run_options.experiment, "JSON file; without one, the default world");
    run.add_option("--seed", run_options.seed, "Otherwise the file's, or one drawn by chance")->check(whole_number);
    run.add_option("--population", run_options.population,
                   "CSV file of `evod export --what population`: begin with these organisms instead of drawn ones");
    run.add_option("--generations", run_options.generations,
                   "How many; takes the place of generation_limit, 0 is no limit")
        ->check(WholeNumber{.max = std::numeric_limits<std::uint32_t>::max()});
    run.add_option("--threads", run_options.threads, "Threads that simulate")
        ->check(thread_count)
        ->capture_default_str();
    run.add_option("--set", run_options.changes, "name=value of a parameter; see evod parameters")->take_all();
    run.add_option("--csv", run_options.csv, "File for the statistics of every generation");
    run.add_flag("--ask", run_options.ask, "Ask for population, food, poison, time and every choice of the algorithm");
    run.footer("Exit status: 0 limit or target reached, 3 stagnation, 4 extinction, 130 interrupted, 1 error.");

    console::CompareOptions compare_options;
    compare_options.jobs = options.threads;
    compare_options.drawn_seed = run_options.drawn_seed;
    CLI::App& compare = *app.add_subcommand(
        "compare", "Did evolution do it? A world beside its controls, or beside other worlds, with the same seeds");
    compare
        .add_option("experiments", compare_options.experiments,
                    "JSON files: one with --controls, without it the default world; or the first against each other")
        ->expected(0, console::compared_max);
    compare.add_flag("--controls", compare_options.controls,
                     "Beside random selection, mutation off, harmless poison and shuffled fitness");
    compare.add_option("--replicates", compare_options.replicates, "Runs of each world, a seed each")
        ->check(CLI::Range(2, 10'000))
        ->capture_default_str();
    compare
        .add_option("--generations", compare_options.generations,
                    "Of each run; otherwise the first file's generation_limit, or " +
                        std::to_string(console::default_generations) + ". No other criterion ends a run")
        ->check(CLI::Range(2, 1'000'000));
    compare
        .add_option("--seed", compare_options.seed, "That the seeds follow from; otherwise the file's, or by chance")
        ->check(whole_number);
    compare.add_option("--jobs", compare_options.jobs, "Runs at a time; nothing that is told depends on it")
        ->check(CLI::Range(1, 1024))
        ->capture_default_str();
    compare.add_option("--set", compare_options.changes, "name=value of a parameter, for all of them")->take_all();
    compare.add_option("--csv", compare_options.csv, "File for the fitness of every run and generation");
    compare.add_option("--picture", compare_options.picture, "File for the curves, as SVG");
    compare.footer("Exit status: 0 compared, 130 interrupted, 1 error.");
    console::SweepOptions sweep_options;
    sweep_options.jobs = options.threads;
    sweep_options.draw_run_id = network::draw_run_id;
    CLI::App& sweep = *app.add_subcommand("sweep", "Run an experiment many times, with other parameters and seeds");
    sweep
        .add_option("sweep", sweep_options.file,
                    "JSON file: an experiment, and a grid, a list or a Latin hypercube of parameters")
        ->required();
    sweep.add_option("--out", sweep_options.out,
                     "Folder for the results, which the same command goes on with; otherwise called like the file, "
                     "without its ending");
    CLI::Option* jobs = sweep.add_option("--jobs", sweep_options.jobs, "Runs at a time, each on one thread")
                            ->check(CLI::Range(1, 1024))
                            ->capture_default_str();
    CLI::Option* run_files =
        sweep.add_flag("--run-files", sweep_options.run_files, "Make a run file of each run, too: FOLDER/run-files");
    CLI::Option* array_index = sweep
                                   .add_option("--array-index", sweep_options.array_index,
                                               "Make the runs of this cell alone, counted from 0: one task of a job "
                                               "array; then, once: --gather")
                                   ->check(whole_number);
    CLI::Option* gather =
        sweep.add_flag("--gather", sweep_options.gather, "Run nothing: write FOLDER/runs.csv, or say what is missing");
    gather->excludes(jobs)->excludes(run_files)->excludes(array_index);
    sweep.add_flag("--dry-run", sweep_options.dry_run, "Write nothing: print cells and seeds")
        ->excludes(gather)
        ->excludes(jobs)
        ->excludes(run_files)
        ->excludes(array_index);
    sweep.footer("Sweep files and job arrays: docs/CLUSTER.md. Exit status: 0 all is there, 1 error, or --gather found "
                 "runs missing, 130 interrupted: the same command goes on.");

    std::string checked_file;
    CLI::App& check = *app.add_subcommand("check", "Say what an experiment file changes, or what is wrong with it");
    check.add_option("experiment", checked_file, "JSON file")->required();

    console::ForkOptions fork_options;
    CLI::App& fork =
        *app.add_subcommand("fork", "Make a second world from a past generation of a run file, or from where it ends");
    fork.add_option("run", fork_options.run_file, "Run file, of a server that runs or not")->required();
    fork.add_option("--at-generation", fork_options.at_generation,
                    "Begins with its first tick; otherwise with the last moment of the file")
        ->check(generation_number);
    fork.add_option("--name", fork_options.name, "Of the new world")->required();
    fork.add_option("--data", fork_options.data_folder,
                    "Folder to make it in, which no server may be using; otherwise where a server keeps its runs");
    fork.footer(
        "It has the seed, the organisms and the parameters that the run had then, and waits to be told to run.");

    network::ServerOptions::Replay replay_options;
    CLI::App& replay_run =
        *app.add_subcommand("replay", "Serve a run file: its past can be watched, and nothing changed");
    replay_run.add_option("run", replay_options.path, "Run file, NAME.evod; the run need not be over")->required();
    replay_run.add_option("--generation", replay_options.generation, "Begins there; otherwise with the first")
        ->check(generation_number);
    replay_run.add_option("--data", options.data_folder, "Folder whose tokens let others in");
    add_common_options(replay_run, options);
    replay_run.footer("Watch it with evoview, go elsewhere in it with evoctl seek, run and pause it as any world.");

    console::VerifyOptions verify_options;
    verify_options.threads = options.threads;
    CLI::App& verify = *app.add_subcommand("verify", "Simulate the run of a run file again and compare everything");
    verify.add_option("run", verify_options.run, "Run file, NAME.evod; the run need not be over")->required();
    verify.add_option("--threads", verify_options.threads, "Threads that simulate")
        ->check(thread_count)
        ->capture_default_str();
    verify.footer("Exit status: 0 all agrees, 1 it does not, or the file is damaged or cannot be simulated again.");

    console::ExportOptions export_options;
    export_options.threads = options.threads;
    CLI::App& export_ = *app.add_subcommand("export", "Write what a run file holds as rows for other programs");
    export_.add_option("run", export_options.run, "Run file, NAME.evod; the run need not be over")->required();
    CLI::Option* what =
        export_
            .add_option(
                "--what", export_options.what,
                "generations: their statistics; organisms: parents, genes and fate of each; lineage: who came of "
                "whom; population: the genes of one generation, for --population; events: the commands")
            ->check(CLI::IsMember({"generations", "organisms", "lineage", "population", "events"}));
    export_.add_option("--of", export_options.of,
                       "GENERATION:ISLAND:ORGANISM: the lineage of this organism alone, back to the first");
    export_
        .add_option("--generation", export_options.generation, "Of the population; otherwise the last that has begun")
        ->check(generation_number);
    export_.add_option("--format", export_options.format, "csv, or jsonl: an object of JSON a line")
        ->check(CLI::IsMember({"csv", "jsonl"}))
        ->capture_default_str();
    CLI::Option* output = export_.add_option("--output", export_options.output, "File; without it, standard output");
    export_.add_option("--threads", export_options.threads, "Threads that simulate again what is not held any more")
        ->check(thread_count)
        ->capture_default_str();

    export_
        .add_option("--bundle", export_options.bundle,
                    "Folder to make, with a copy of the run file, all tables, checksums and how to repeat the run")
        ->excludes(what)
        ->excludes(output);

    std::string token_folder, token_name, token_role;
    CLI::App& token = *app.add_subcommand("token", "Who may come in from other machines, and as what");
    token.require_subcommand(1);
    const auto add_token_folder = [&](CLI::App& command) {
        command.add_option("--data", token_folder,
                           "Folder of the server's runs; otherwise where it keeps them by itself");
    };
    CLI::App& token_add = *token.add_subcommand("add", "Make a token; it is told once, on standard output");
    token_add.add_option("name", token_name, "Whose, 1 to 64 of a-z A-Z 0-9 _ - .")->required();
    token_add
        .add_option("--role", token_role,
                    "viewer: looks; controller: and runs worlds and sets parameters; admin: and makes and deletes "
                    "worlds, and shuts the server down")
        ->required()
        ->check(CLI::IsMember({"viewer", "controller", "admin"}));
    add_token_folder(token_add);
    CLI::App& token_list = *token.add_subcommand("list", "Names and roles of all tokens");
    add_token_folder(token_list);
    CLI::App& token_revoke = *token.add_subcommand("revoke", "Make a token useless; whoever is in with it is put out");
    token_revoke.add_option("name", token_name, "Whose")->required();
    add_token_folder(token_revoke);

    std::vector<std::string> certificate_hosts;
    std::string certificate_folder = ".";
    CLI::App& certificate = *app.add_subcommand("certificate", "Make a key and a certificate of its own for TLS");
    certificate
        .add_option("host", certificate_hosts, "Names and IP addresses under which clients will reach the server")
        ->required();
    certificate.add_option("--folder", certificate_folder, "Where evod.key and evod.crt are made")
        ->capture_default_str();
    certificate.footer("Then: evod --tls-cert evod.crt --tls-key evod.key, and evoctl --ca evod.crt. Good for " +
                       std::to_string(access::certificate_days) + " days.");

    const CLI::App& parameters =
        *app.add_subcommand("parameters", "Print every parameter, as docs/PARAMETERS.md has it");
    const CLI::App& limits =
        *app.add_subcommand("limits", "Print every limit of the network, as docs/OPERATIONS.md has it");

    app.require_subcommand(0, 1);
    try {
        app.parse(argument_count, arguments);
        hand_down(app);
    } catch (const CLI::ParseError& error) {
        const int status = app.exit(error) == 0 ? 0 : 2;
        if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::ExtrasError) && app.get_subcommands().empty()) {
            std::cerr << "Commands are";
            for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
                std::cerr << ' ' << command->get_name();
            std::cerr << '\n';
        }
        return status;
    }
    if (run.parsed())
        return console::run(run_options);
    if (compare.parsed())
        return console::compare(compare_options);
    if (sweep.parsed())
        return console::sweep(sweep_options);
    if (check.parsed())
        return console::check(checked_file);
    if (fork.parsed()) {
        fork_options.data_folder = folder_of_runs(fork_options.data_folder);
        if (fork_options.data_folder.empty())
            return fail(no_folder);
        fork_options.run_id = network::draw_run_id();
        return console::fork(fork_options);
    }
    if (token.parsed()) {
        token_folder = folder_of_runs(token_folder);
        if (token_folder.empty())
            return fail(no_folder);
        if (token_list.parsed())
            return console::list_tokens(token_folder);
        if (token_revoke.parsed())
            return console::revoke_token(token_folder, token_name);
        return console::add_token(token_folder, token_name, *access::role_named(token_role));
    }
    if (certificate.parsed()) {
        if (const auto made = access::make_certificate(certificate_hosts, certificate_folder); !made)
            return fail("certificate: " + to_text(made.error()));
        return 0;
    }
    if (verify.parsed())
        return console::verify(verify_options);
    if (export_.parsed())
        return console::export_run(export_options);
    if (parameters.parsed()) {
        std::cout << console::parameter_list();
        return 0;
    }
    if (limits.parsed()) {
        std::cout << network::limit_list();
        return 0;
    }

    serves = true;
    log::begin(log::level_named(options.log_level),
               options.log_format == "json" ? log::Format::Json : log::Format::Text);
    return replay_run.parsed() ? replay(options, replay_options) : serve(options);
}

} // namespace

int main(int argument_count, char** arguments) {
    bool serves = false;
    const int status = perform(argument_count, arguments, serves);
    if (serves || (std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout.flush()))
        return status;
    const int failed = fail("standard output cannot be written: the disk may be full");
    return status == 0 ? failed : status;
}
