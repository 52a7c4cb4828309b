// The server: `evod` without a subcommand, and `evod replay`.
#include "proto/command_line/command.h"
#include "server/base/instructions.h"
#include "server/commands/commands.h"
#include "server/commands/common_options.h"
#include "server/commands/serve_options.h"
#include "server/log/log.h"
#include "server/network/server.h"

#include <sys/resource.h>

#include <atomic>
#include <initializer_list>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace evod::commands {
namespace {

using command_line::Command;

constexpr int exit_not_written = 4;

std::atomic<bool> is_logging = false;

void begin_log(const ServeOptions& options) {
    is_logging = true;
    log::begin(log::level_named(options.log_level),
               options.log_format == "json" ? log::Format::Json : log::Format::Text);
}

/// Raises the limit of file descriptors to the maximum that the system allows. Each connection takes one descriptor,
/// and the usual limit of 1,024 is soon reached.
void raise_descriptor_limit() {
    rlimit limit{};
    if (::getrlimit(RLIMIT_NOFILE, &limit) == 0) {
        limit.rlim_cur = limit.rlim_max;
        ::setrlimit(RLIMIT_NOFILE, &limit);
    }
}

/// Logs where browsers find the page and the metrics, and how to let other users in.
void log_http_address(const boost::asio::ip::tcp::endpoint& http, const network::PageAddress& page, bool encrypted) {
    const std::string address = http.address().to_string();
    log::info("metrics and health at {}://{}:{}/metrics and /healthz", encrypted ? "https" : "http",
              http.address().is_v6() ? "[" + address + "]" : address, http.port());
    if (page.port == 0) {
        log::warn("this evod was built without the page for browsers: see the CMake option EVOD_BUILD_WEB");
        return;
    }
    const std::string url = network::url_of(page);
    log::info("page at {}", url);
    if (!page.is_local) {
        log::info("other users open {}#token=TOKEN; evod token add NAME --role viewer makes a token", url);
    }
}

void warn_if_not_encrypted(std::initializer_list<boost::asio::ip::address> addresses) {
    std::string open;
    for (const boost::asio::ip::address& address : addresses) {
        const std::string text = address.to_string();
        if (!address.is_loopback() && text != open) {
            open += (open.empty() ? "" : " and ") + text;
        }
    }
    if (!open.empty()) {
        log::warn("without TLS, any machine on the network path to {} can read tokens and use them: see --tls-cert",
                  open);
    }
}

/// Logs which processes share the worlds.
void log_processes(const SharedWork& shared) {
    std::string others;
    for (std::uint32_t rank = 1; rank < shared.processes.size(); ++rank) {
        others += (others.empty() ? "" : ", ") + shared.processes.name_of(rank);
    }
    if (!others.empty()) {
        log::info("worlds with at least {} islands are shared with {}", shared.processes.size(), others);
    }
}

/// What the server serves at first, for the line that reports its address: ", world …", or ", replay of …".
std::string content_of(const network::Server& server) {
    if (const auto* run = std::get_if<network::ReplayedRun>(&server.options().worlds)) {
        return ", replay of " + run->path;
    }
    const auto seed = server.first_seed();
    const std::string& name = std::get<network::LiveWorlds>(server.options().worlds).first_world.world.name;
    return seed ? ", world \"" + name + "\", seed " + std::to_string(seed->value) : "";
}

/// Reads the options of the running server again, after SIGHUP. Sets the level of the log, and logs which other options
/// wait for the next start.
///
/// app      as parsed when the server started.
std::optional<network::ChangeableOptions> reread(const Command& app) {
    Command again{app.name(), "", ""};
    ServeOptions options;
    add_all_options(again, options);
    const std::vector<std::string> errors = again.read(app.words());
    for (const std::string& error : errors) {
        log::error("SIGHUP: the configuration stays as it is: {}", error);
    }
    const auto tls = tls_files(options.tls);
    if (!tls && errors.empty()) {
        log::error("SIGHUP: the configuration stays as it is: {}", tls.error().message);
    }
    if (!tls || !errors.empty()) {
        return std::nullopt;
    }
    const auto before = app.given(), now = again.given();
    if (!now.contains("--config")) {
        return network::ChangeableOptions{.tls = *tls, .storage = options.storage};
    }
    log::info("SIGHUP: configuration reloaded from {}", now.at("--config").front());
    log::set_level(log::level_named(options.log_level));
    std::set<std::string> changeable{"--log-level", "--keep-runs", "--disk-max"};
    if (before.contains("--tls-cert") && now.contains("--tls-cert")) {
        changeable.insert({"--tls-cert", "--tls-key", "--tls-client-ca"});
    }
    for (const command_line::OptionDescription& option : again.options()) {
        const std::string& name = option.names.back();
        const auto value = [&name](const auto& given) {
            const auto found = given.find(name);
            return found == given.end() ? std::vector<std::string>{} : found->second;
        };
        if (!changeable.contains(name) && value(before) != value(now)) {
            log::warn("SIGHUP: {} takes effect at the next start", name.substr(2));
        }
    }
    return network::ChangeableOptions{.tls = *tls, .storage = options.storage};
}

/// Runs the server until a signal or a ShutDown request ends it. Returns the exit status.
int run_server(base::Result<network::ServerOptions> options) {
    if (!options) {
        return fail(options.error());
    }
    raise_descriptor_limit();
    const auto server = network::Server::open(*std::move(options));
    if (!server) {
        return fail(server.error());
    }
    const auto* const live = std::get_if<network::LiveWorlds>(&(*server)->options().worlds);
    if (live != nullptr && live->storage) {
        log::info("runs are stored in {}", live->storage->folder);
    }
    log::info("vector instructions: {}", base::name_of(base::instructions()));
    const bool encrypted = (*server)->options().listeners.tls.has_value();
    const auto endpoint = (*server)->endpoint();
    const auto http = (*server)->http_endpoint();
    if (!encrypted) {
        warn_if_not_encrypted({endpoint.address(), http ? http->address() : endpoint.address()});
    }
    if (http) {
        log_http_address(*http, (*server)->page(), encrypted);
    }
    log::info("evod {} listening on {}:{}{}", EVOD_VERSION, endpoint.address().to_string(), endpoint.port(),
              content_of(**server));
    const bool all_written = (*server)->run();
    log::info("stopped");
    return all_written ? 0 : exit_not_written;
}

} // namespace

bool is_server() {
    return is_logging;
}

void add_server(Command& app) {
    auto& options = app.keep(ServeOptions{});
    add_all_options(app, options);
    app.footer("Without a subcommand, evod starts a server.");
    app.hand_options_down("the server");
    app.action([&options, &app] {
        begin_log(options);
        return share_worlds("server", options.sharing, true, [&options, &app](const SharedWork& shared) {
            log_processes(shared);
            auto server = server_options(options, shared.maker == nullptr ? std::nullopt
                                                                          : std::optional{network::SharingProcesses{
                                                                                shared.processes, *shared.maker}});
            if (server) {
                server->threads = shared.threads;
                server->reread = [&app] { return reread(app); };
            }
            return run_server(std::move(server));
        });
    });
}

void add_replay_command(Command& app) {
    auto& command = app.add_command("replay", "Serve a stored run as a replay, which clients can view but not change")
                        .group("Run files");
    auto& options = command.keep(ServeOptions{});
    auto& run = command.keep(network::ReplayedRun{});
    command.add_option("run", &run.path, "Run file, NAME.evod; the run may still be in progress").required();
    command
        .add_option("--generation", &run.generation,
                    "Generation that the replay shows first; default: the first one in the file")
        .check(generation_number);
    command
        .add_option("--threads", &options.sharing.threads,
                    "Number of simulation threads; default: the number of processors")
        .check(thread_count);
    command.add_option("--data", &options.data_folder,
                       "Folder with the token file; default: $XDG_STATE_HOME/evod or ~/.local/state/evod");
    add_server_options(command, options);
    command.footer("View the replay with evoview, move it to another moment with evoctl seek, and run or pause it like "
                   "any world.");
    command.action([&options, &run] {
        begin_log(options);
        return run_server(replay_server_options(options, run));
    });
}

} // namespace evod::commands
