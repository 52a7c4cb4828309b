#include "client/ctl/caller.h"

#include "client/core/page_link.h"
#include "client/ctl/text.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <cmath>
#include <csignal>
#include <iostream>
#include <termios.h>
#include <unistd.h>

namespace evod::ctl {

namespace {

core::Endpoint endpoint_of(const std::string& text) {
    auto endpoint = core::parse_endpoint(text);
    if (!endpoint) {
        throw Stop{ExitCode::Usage, "--server: " + endpoint.error().what};
    }
    return *std::move(endpoint);
}

/// Switches the terminal's echo off during the lifetime of this object. Restores it even if a signal ends the program.
class EchoOff {
  public:
    explicit EchoOff(const termios& original) {
        echoing = original;
        struct sigaction restore {};
        restore.sa_handler = [](int number) {
            ::tcsetattr(STDIN_FILENO, TCSANOW, &echoing);
            std::signal(number, SIG_DFL);
            std::raise(number); // the signal is delivered when this handler returns, and ends the program
        };
        for (std::size_t i = 0; i < signals.size(); ++i) {
            ::sigaction(signals[i], &restore, &before_[i]);
        }
        termios silent = original;
        silent.c_lflag &= ~static_cast<tcflag_t>(ECHO);
        ::tcsetattr(STDIN_FILENO, TCSADRAIN, &silent);
    }
    EchoOff(const EchoOff&) = delete;
    ~EchoOff() {
        ::tcsetattr(STDIN_FILENO, TCSADRAIN, &echoing);
        for (std::size_t i = 0; i < signals.size(); ++i) {
            ::sigaction(signals[i], &before_[i], nullptr);
        }
    }

  private:
    static constexpr std::array signals{SIGINT, SIGTERM, SIGHUP, SIGQUIT};
    static inline termios echoing{};
    std::array<struct sigaction, signals.size()> before_{};
};

/// Asks for the token on the terminal and returns it. Does not show what the user types. Empty if there is no terminal.
std::string prompt_for_token(const std::string& server) {
    termios original{};
    if (::isatty(STDIN_FILENO) != 1 || ::isatty(STDERR_FILENO) != 1 || ::tcgetattr(STDIN_FILENO, &original) != 0) {
        return {};
    }
    std::string token;
    {
        // Echo is switched off before the prompt, so that text that is typed or pasted early is neither shown nor lost.
        const EchoOff echo_off{original};
        std::cerr << "token for " << server << ": " << std::flush;
        std::cin >> token;
    }
    std::cerr << '\n';
    return token;
}

std::atomic<bool> interrupt_seen = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may write it");

} // namespace

Caller::Caller(const Common& common) : timeout_{common.timeout()} {
    core::Options options{.server = endpoint_of(common.server),
                          .client_name = "evoctl",
                          .client_version = EVOD_VERSION,
                          .connect_timeout = common.timeout(),
                          .unreachable_max = common.timeout()};
    if (const auto applied = core::apply(common.credentials, options); !applied) {
        throw Stop{ExitCode::Usage, applied.error().what};
    }
    connection_ = std::make_unique<core::Connection>(options);
    auto welcome = connection_->wait_connected(timeout_ + std::chrono::seconds{1});
    if (!welcome && welcome.error().kind == core::Error::Kind::TokenNeeded && options.token.empty() &&
        common.may_prompt) {
        options.token = prompt_for_token(common.server);
        connection_ = std::make_unique<core::Connection>(options);
        welcome = connection_->wait_connected(timeout_ + std::chrono::seconds{1});
    }
    if (!welcome) {
        const bool stranger = welcome.error().kind == core::Error::Kind::TokenNeeded;
        throw Stop{stranger ? ExitCode::TokenNeeded : ExitCode::NoConnection, welcome.error().what};
    }
    welcome_ = *std::move(welcome);
    page_ = core::page_of(welcome_, options.server, options.tls.has_value());
    other_page_host_ = core::other_page_host(welcome_, options.server);
}

v1::Response Caller::call(v1::Request request, std::optional<std::chrono::milliseconds> timeout) {
    const bool changes = !request.has_get_parameters();
    auto response = connection_->request(std::move(request), timeout.value_or(timeout_));
    if (!response) {
        const bool usage = response.error().kind == core::Error::Kind::Usage;
        const bool late = response.error().kind == core::Error::Kind::Timeout;
        throw Stop{usage ? ExitCode::Usage : ExitCode::NoConnection,
                   response.error().what + (late ? "; if the server is busy, wait longer with --timeout" : "")};
    }
    if (changes) {
        for (const std::string& warning : response->warnings()) {
            std::cerr << visible("evoctl: warning: " + warning + "\n");
        }
    }
    if (!core::accepted(*response)) {
        const bool wrong = response->status().code() == v1::CODE_INVALID_ARGUMENT;
        // The server has had the command before a reconnection, and may have applied it.
        const bool expired = response->status().reason() == v1::REASON_REQUEST_TOO_OLD;
        throw Stop{wrong     ? ExitCode::Usage
                   : expired ? ExitCode::NoConnection
                             : ExitCode::Refused,
                   core::to_text(response->status()), response->status()};
    }
    return *std::move(response);
}

Registry Caller::registry() {
    v1::Request request;
    request.mutable_describe();
    return Registry{call(std::move(request)).description()};
}

v1::WorldInfo Caller::world(const std::string& name) {
    v1::Request request;
    request.mutable_get_statistics()->set_world(name);
    return call(std::move(request)).statistics().world();
}

v1::Storage Caller::storage() {
    v1::Request request;
    request.mutable_list_worlds();
    const v1::Response response = call(std::move(request));
    for (const v1::WorldInfo& world : response.worlds().worlds()) {
        if (world.has_storage()) {
            return world.storage();
        }
    }
    return welcome_.storage(); // there is no world, so none can wait for the disk
}

v1::History Caller::history(v1::GetHistory wanted) {
    v1::History all;
    for (bool more = true; more;) {
        v1::Request request;
        *request.mutable_get_history() = wanted;
        v1::Response response = call(std::move(request));
        auto& history = *response.mutable_history();
        more = history.has_next_generation();
        if (more && wanted.has_first_generation() && history.next_generation() <= wanted.first_generation()) {
            throw Stop{ExitCode::Refused, "the server's history does not continue after generation " +
                                              std::to_string(wanted.first_generation())};
        }
        wanted.set_first_generation(history.next_generation());
        all.mutable_generations()->MergeFrom(history.generations());
        all.mutable_changes()->MergeFrom(history.changes());
    }
    return all;
}

void Caller::export_run(v1::ExportRun wanted, const std::function<bool(const v1::ExportPart&)>& write) {
    // It is long because the server may have to simulate purged generations again.
    constexpr std::chrono::minutes part_timeout{60};
    v1::Request request;
    *request.mutable_export_run() = std::move(wanted);
    v1::ExportPart part = call(std::move(request), part_timeout).export_part();
    while (write(part) && !part.last()) {
        v1::Request next;
        next.mutable_continue_export()->set_export_id(part.export_id());
        part = call(std::move(next), part_timeout).export_part();
    }
}

void Caller::require_subscribed(core::SubscriptionHandle subscription) const {
    const auto answer = connection_->subscription_answer(subscription);
    if (answer && !core::accepted(*answer)) {
        throw Stop{ExitCode::Refused, core::to_text(answer->status())};
    }
}

void Caller::need(const std::string& feature, const std::string& what) const {
    const auto& features = welcome_.features();
    if (std::find(features.begin(), features.end(), feature) == features.end()) {
        throw Stop{ExitCode::Refused, "this server cannot " + what + ": it is evod " + welcome_.server_version() +
                                          ", which is older than this evoctl"};
    }
}

std::string state_of(const v1::WorldInfo& world) {
    if (world.frozen() && world.state() != v1::RUN_STATE_TERMINATED) {
        return "frozen";
    }
    switch (world.state()) {
    case v1::RUN_STATE_WAITING:
        return "waiting";
    case v1::RUN_STATE_RUNNING:
        return core::worlds_wait(world.storage()) ? "waits for the disk"
               : world.has_awaited_fitness()      ? "waits for fitness"
                                                  : "running";
    case v1::RUN_STATE_PAUSED:
        return "paused";
    case v1::RUN_STATE_TERMINATED:
        switch (world.outcome()) {
        case v1::OUTCOME_GENERATION_LIMIT:
            return "ended: generation limit";
        case v1::OUTCOME_TARGET_FITNESS:
            return "ended: target fitness";
        case v1::OUTCOME_STAGNATION:
            return "ended: stagnation";
        case v1::OUTCOME_EXTINCTION:
            return "ended: extinction";
        default:
            return "ended";
        }
    default:
        return "unknown";
    }
}

std::string colored_state_of(const v1::WorldInfo& world) {
    const std::string state = state_of(world);
    if (world.state() == v1::RUN_STATE_TERMINATED) {
        return world.outcome() == v1::OUTCOME_EXTINCTION ? in_color(state, Color::Red) : state;
    }
    if (world.state() != v1::RUN_STATE_RUNNING) {
        return state;
    }
    return in_color(state, state == "running" ? Color::Green : Color::Yellow);
}

std::string durability_warning(const v1::Welcome& welcome) {
    switch (welcome.durability()) {
    case v1::DURABILITY_NONE:
        return "runs are not recorded: worlds end with the server";
    case v1::DURABILITY_RELAXED:
        return "durability relaxed: acknowledged commands survive a crash of evod, but perhaps not of the machine";
    default:
        return "";
    }
}

std::string speed_of(const v1::WorldInfo& world) {
    const v1::Speed& speed = world.speed();
    return (speed.has_real_time_factor() ? speed_text(speed.real_time_factor()) : "max") +
           (world.slowed() ? " (slower)" : "");
}

v1::Speed parse_speed(std::string_view word) {
    v1::Speed speed;
    if (word == "max") {
        speed.set_max(true);
        return speed;
    }
    std::string_view number = word; // as speed_text() prints it: "2×", "1/8×"
    for (const std::string_view sign : {"x", "×"}) {
        if (number.ends_with(sign)) {
            number.remove_suffix(sign.size());
        }
    }
    const bool is_fraction = number.starts_with("1/");
    number.remove_prefix(is_fraction ? 2 : 0);
    double factor = 0;
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), factor);
    if (error != std::errc{} || end != number.data() + number.size() || !std::isfinite(factor)) {
        throw Stop{ExitCode::Usage, "SPEED: got " + std::string{word} +
                                        ", allowed max, or 0.001 to 10000, such as 2 for twice real time"};
    }
    factor = is_fraction ? 1 / factor : factor; // the server refuses 1/0
    speed.set_real_time_factor(factor);
    return speed;
}

std::string sentence(const v1::WorldInfo& world) {
    std::string text = world.name() + ": " + colored_state_of(world) + " at " + speed_of(world) + ", generation " +
                       std::to_string(world.generation()) + ", tick " + std::to_string(world.tick()) + " (" +
                       duration(world.simulated_s()) + ")";
    if (world.has_awaited_fitness()) {
        text += (world.state() == v1::RUN_STATE_RUNNING ? ", " : ", waits for fitness, ") +
                core::to_text(world.awaited_fitness(), world.island_count());
    }
    // A replay stops at its end and waits there, even if its goal is later.
    const bool under_way = world.state() == v1::RUN_STATE_RUNNING || world.state() == v1::RUN_STATE_PAUSED ||
                           (world.state() == v1::RUN_STATE_WAITING && world.has_replay());
    if (under_way && world.has_run_until_generation()) {
        text += ", until the end of generation " + std::to_string(world.run_until_generation() - 1);
    }
    if (under_way && world.has_run_until_tick()) {
        text += ", until tick " + std::to_string(world.run_until_tick());
    }
    if (world.has_replay() && world.tick() >= world.replay().last_tick()) {
        text += ", the last tick in its run file: evoctl seek moves it to another";
    }
    return text;
}

void stop_for(const Mistakes& mistakes) {
    std::string text;
    for (const std::string& line : mistakes.lines) {
        text += (text.empty() ? "" : "\n") + line;
    }
    throw Stop{ExitCode::Usage, text};
}

void catch_interrupts() {
    std::signal(SIGINT, [](int) { interrupt_seen = true; });
    std::signal(SIGTERM, [](int) { interrupt_seen = true; });
}

bool interrupted() {
    return interrupt_seen;
}

bool on_terminal() {
    return ::isatty(STDOUT_FILENO) == 1;
}

} // namespace evod::ctl
