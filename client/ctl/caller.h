// Caller: one call's line to the server. What goes wrong ends the call: see Stop.
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
#include <limits>
#include <memory>
#include <optional>
#include <string>

namespace evod::command_line {
class Command;
}

namespace evod::ctl {

/// What every subcommand can be given.
struct Common {
    std::string server = "localhost";
    core::Credentials credentials;
    std::string world; // empty: the server's only one, or `default`
    double timeout_s = 10;
    bool json = false;
    bool may_prompt = true; // for a token, whoever sits at the terminal

    std::chrono::milliseconds timeout() const {
        return std::chrono::milliseconds{static_cast<std::int64_t>(timeout_s * 1000)};
    }
};

class Caller {
  public:
    /// Connects, or throws Stop.
    explicit Caller(const Common& common);

    /// The server's answer; throws Stop if it refuses or none comes, within that time or the one of every call.
    v1::Response call(v1::Request request, std::optional<std::chrono::milliseconds> timeout = {});

    /// The server's registry of parameters.
    Registry registry();
    /// The world that is meant, as it is now.
    v1::WorldInfo world(const std::string& name);
    /// How it stands with the server's disk, as it is now.
    v1::Storage storage();

    /// Throws Stop if the server does not know of them: it would make them at once, or not at all.
    void need_planned_changes() const;

    core::Connection& connection() { return *connection_; }
    const v1::Welcome& welcome() const { return welcome_; }
    std::chrono::milliseconds timeout() const { return timeout_; }

  private:
    std::chrono::milliseconds timeout_;
    std::unique_ptr<core::Connection> connection_;
    v1::Welcome welcome_;
};

/// Prints an answer as JSON if that was asked for, else as `text` writes it.
template <class Text>
void print(const Common& common, const google::protobuf::Message& answer, const Text& text) {
    const std::string output = common.json ? to_json(answer) : visible(text());
    std::fwrite(output.data(), 1, output.size(), stdout);
}

/// "running", "paused", …, "waits for the disk".
std::string state_of(const v1::WorldInfo& world);
/// "commands are refused: the disk is full", "worlds wait for the disk: …"; empty while it keeps up.
std::string trouble_of(const v1::Storage& storage);
/// What becomes of a command that was answered, where the machine may lose it; empty where it may not.
std::string durability_of(const v1::Welcome& welcome);
/// What it was told, and whether the machine cannot keep up with that: "2x", "max", "100x (slower)".
std::string speed_of(const v1::WorldInfo& world);
/// One world in a sentence: "default: running at 1x, generation 4, tick 9,000 of 2:30 min".
std::string sentence(const v1::WorldInfo& world);

/// Throws Stop with every mistake on a line of its own.
[[noreturn]] void stop_for(const std::string& what, const Mistakes& mistakes);

/// Ctrl-C from here on sets a flag instead of ending the program.
void catch_interrupts();
bool interrupted();
/// Whether people are looking at stdout.
bool on_terminal();

/// Checks of options.
inline constexpr command_line::WholeNumber whole_number{}, at_least_one{.min = 1},
    index_number{.max = std::numeric_limits<std::uint32_t>::max()}; // of islands and organisms

/// Each adds its subcommands to `app`.
void add_look_commands(command_line::Command& app, const Common& common);
void add_parameter_commands(command_line::Command& app, const Common& common);
void add_run_commands(command_line::Command& app, const Common& common);
void add_breeding_command(command_line::Command& app, const Common& common);
void add_export_command(command_line::Command& app, const Common& common);
void add_watch_commands(command_line::Command& app, const Common& common);
void add_top_command(command_line::Command& app, const Common& common);
void add_complete_command(command_line::Command& app);

/// Prints what may come next after `words`, the last of which is being typed; nothing where no server is needed and
/// none is there.
void complete(const command_line::Command& app, const std::vector<std::string>& words);

} // namespace evod::ctl
