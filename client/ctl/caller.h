// Caller: the connection of one evoctl call to the server. On an error the functions throw Stop, which ends the call.
#pragma once

#include "client/core/connection.h"
#include "client/core/credentials.h"
#include "client/ctl/json.h"
#include "client/ctl/registry.h"
#include "client/ctl/stop.h"
#include "client/ctl/text.h"
#include "proto/command_line/number.h"

#include <google/protobuf/message.h>

#include <chrono>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace evod::command_line {
class Command;
struct Candidate;
struct IncompleteWord;
} // namespace evod::command_line

namespace evod::ctl {

/// Options of every subcommand.
struct Common {
    std::string server = "localhost";
    core::Credentials credentials;
    std::string world; // empty: the server's only world, or `default` if there are several
    double timeout_s = 10;
    bool json = false;
    bool may_prompt = true; // whether evoctl may ask for a token on the terminal

    std::chrono::milliseconds timeout() const {
        return std::chrono::milliseconds{static_cast<std::int64_t>(timeout_s * 1000)};
    }
};

class Caller {
  public:
    /// Connects, or throws Stop.
    explicit Caller(const Common& common);

    /// Sends a request and returns the server's response. Throws Stop if the server refuses the request, or does not
    /// answer within `timeout`, which is --timeout by default. Prints the warnings about a change to stderr.
    v1::Response call(v1::Request request, std::optional<std::chrono::milliseconds> timeout = {});

    /// Returns the server's registry of parameters.
    Registry registry();
    /// Returns the current state of a world. If `name` is empty, chooses the world as described at Common::world.
    v1::WorldInfo world(const std::string& name);
    /// Returns the current state of the server's storage.
    v1::Storage storage();
    /// Returns the whole history that is wanted, with as many requests as it needs.
    v1::History history(v1::GetHistory wanted);
    /// Exports a table, and calls `write` with each part. Ends after a part for which `write` returns false.
    void export_run(v1::ExportRun wanted, const std::function<bool(const v1::ExportPart&)>& write);

    /// Throws Stop if the server does not have a feature. An older server would ignore fields that it does not know.
    ///
    /// what  what the server cannot do without the feature: "plan changes of parameters".
    void need(const std::string& feature, const std::string& what) const;

    /// Throws Stop if the server has refused a subscription, for example after a reconnection because the world is
    /// gone.
    void require_subscribed(core::SubscriptionHandle subscription) const;

    core::Connection& connection() { return *connection_; }
    const v1::Welcome& welcome() const { return welcome_; }
    /// The address of the server's page, such as "http://lab:7745/". Empty if there is none that this machine can
    /// reach.
    const std::string& page() const { return page_; }
    /// The host of the page if it is another one than that of --server; else empty.
    const std::string& other_page_host() const { return other_page_host_; }
    std::chrono::milliseconds timeout() const { return timeout_; }

  private:
    std::chrono::milliseconds timeout_;
    std::unique_ptr<core::Connection> connection_;
    v1::Welcome welcome_;
    std::string page_, other_page_host_;
};

/// Prints a reply: as JSON if --json was given, otherwise as the result of `text()`.
template <class Text>
void print(const Common& common, const google::protobuf::Message& answer, const Text& text) {
    const std::string output = common.json ? to_json(answer) : visible(text());
    std::fwrite(output.data(), 1, output.size(), stdout);
}

/// Returns the state of a world in words: "running", "paused", …, "waits for the disk", "waits for fitness".
std::string state_of(const v1::WorldInfo& world);
/// Returns the state in a colour: green while the world runs, yellow if it waits, red if it is extinct.
std::string colored_state_of(const v1::WorldInfo& world);
/// Returns a warning if acknowledged commands may be lost, for example when the machine fails; empty otherwise.
std::string durability_warning(const v1::Welcome& welcome);
/// Returns the requested speed, and whether the world is slower than requested: "2×", "max", "100× (slower)".
std::string speed_of(const v1::WorldInfo& world);
/// Parses a speed as users type it, and as speed_text() prints it: "max", "2", "2×", "1/8×". Throws Stop.
v1::Speed parse_speed(std::string_view word);
/// Describes a world in a sentence: "default: running at 1×, generation 4, tick 9,000 of 2:30 min".
std::string sentence(const v1::WorldInfo& world);

/// Throws Stop with one line for each mistake.
[[noreturn]] void stop_for(const Mistakes& mistakes);

/// From now on Ctrl-C sets a flag instead of ending the program.
void catch_interrupts();
bool interrupted();
/// Returns whether stdout is a terminal.
bool on_terminal();

/// Rules for whole numbers given as options.
inline constexpr command_line::WholeNumber whole_number{}, at_least_one{.min = 1},
    index_number{.max = std::numeric_limits<std::uint32_t>::max()}; // an index of an island or organism

/// Each of these functions adds a group of subcommands to `app`.
void add_query_commands(command_line::Command& app, const Common& common);
void add_parameter_commands(command_line::Command& app, const Common& common);
void add_place_commands(command_line::Command& app, const Common& common);
void add_link_command(command_line::Command& app, const Common& common);
void add_rate_command(command_line::Command& app, const Common& common);
void add_run_commands(command_line::Command& app, const Common& common);
void add_breeding_command(command_line::Command& app, const Common& common);
void add_export_command(command_line::Command& app, const Common& common);
void add_class_commands(command_line::Command& app, const Common& common);
void add_note_command(command_line::Command& app, const Common& common);
void add_watch_commands(command_line::Command& app, const Common& common);
void add_top_command(command_line::Command& app, const Common& common);

/// Returns completions that the server knows: names of worlds and parameters. Empty if it does not answer.
std::vector<command_line::Candidate> values_of_server(const command_line::IncompleteWord& incomplete);

} // namespace evod::ctl
