// Command line: the options and subcommands of a program, their help, and what each subcommand does. evod, evoctl and
// evoview describe theirs with this header. CLI11 reads the command line and prints the help; command.cpp alone
// includes it, because every source that does takes seven seconds longer to compile.
//
// Owner    main. Variables that options write must outlive parse() and run(); keep() gives them the command's lifetime.
// Threads  one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace CLI {
class App;
class Option;
} // namespace CLI

namespace evod::command_line {

/// Exit status after an error of the command line.
constexpr int exit_usage = 2;

/// The variable that receives the value of an option. Its type decides how the value is read and what the help calls
/// it. A vector takes several values.
using Target =
    std::variant<std::string*, std::vector<std::string>*, int*, std::int64_t*, std::uint16_t*, std::uint32_t*,
                 std::uint64_t*, double*, std::optional<std::string>*, std::optional<std::uint16_t>*,
                 std::optional<std::uint32_t>*, std::optional<std::uint64_t>*, std::optional<double>*>;

/// Says what is wrong with a value as it was typed; an empty text accepts it. The message is printed after the name of
/// the option.
using Check = std::function<std::string(const std::string& word)>;

/// A handle of an option or flag, valid as long as its command. Every setter returns the same handle.
class Option {
  public:
    explicit Option(CLI::Option* option) : option_{option} {}

    Option check(Check check) const;
    /// One of these words; the help shows them.
    Option choices(const std::vector<std::string>& choices) const;
    /// How many values a vector takes.
    Option count(int min, int max) const;
    Option required() const;
    /// Rejected unless the other is given, too.
    Option needs(Option other) const;
    /// Rejected where the other is given, too.
    Option excludes(Option other) const;
    /// The variable that holds the value where the command line does not.
    Option environment(const std::string& variable) const;
    /// The help shows the value that the target has now.
    Option show_default() const;

    /// Whether the command line or the environment had a value.
    bool is_given() const;

  private:
    CLI::Option* option_; // CLI11's App owns it
};

/// The program itself or one of its subcommands.
class Command {
  public:
    /// A program. version  what --version prints.
    Command(const std::string& name, const std::string& help, const std::string& version);
    Command(Command&&) = default;

    /// name  "--seed", or "run" for a value without a name before it, or both: "server,--server".
    Option add_option(const std::string& name, Target target, const std::string& help);
    Option add_flag(const std::string& name, bool* target, const std::string& help);
    /// The reference stays valid. One subcommand must be given, unless this command has an action of its own.
    Command& add_command(const std::string& name, const std::string& help);

    /// The heading under which the help of the program lists this subcommand.
    Command& group(const std::string& heading);
    /// Printed after the options. Subcommands that are added later inherit it.
    Command& footer(const std::string& text);
    /// The column at which the help begins to explain options.
    Command& help_column(std::size_t column);
    /// Options of this command may also follow the subcommand. Holds for subcommands that are added later.
    Command& accept_options_after_commands();
    /// Options given before a subcommand count as given to it. An option that it does not have is rejected as one of
    /// `owner`, because it would have no effect.
    Command& hand_options_down(const std::string& owner);

    /// What the command does. Returns the exit status, or nothing for 0.
    template <class Action>
    Command& action(Action action) {
        if constexpr (std::is_void_v<std::invoke_result_t<Action&>>) {
            return set_action([action = std::move(action)]() mutable {
                action();
                return 0;
            });
        } else {
            return set_action(std::move(action));
        }
    }
    /// Stores a value as long as the command exists: what its options write and its action reads.
    template <class Value>
    Value& keep(Value value) {
        auto kept = std::make_shared<Value>(std::move(value));
        kept_.push_back(kept);
        return *kept;
    }

    /// Reads the command line. Returns nothing if run() can follow; otherwise the exit status, after it has printed the
    /// help, the version or the error.
    std::optional<int> parse(int argument_count, const char* const* arguments);
    /// Runs the action of the subcommand that was given, or of the program if none was. Returns the exit status.
    int run();
    /// Prints an error that parse() cannot see, as parse() prints its own. Returns the exit status.
    int reject(const std::string& error) const;

    std::string name() const;
    const std::list<Command>& commands() const { return commands_; }
    /// "--help", "--seed", …: names that begin with two dashes.
    std::vector<std::string> option_names() const;

  private:
    explicit Command(std::shared_ptr<CLI::App> app) : app_{std::move(app)} {}
    Command& set_action(std::function<int()> action);

    std::shared_ptr<CLI::App> app_;
    std::list<Command> commands_;
    std::function<int()> action_;
    std::string owner_; // of options that are handed down; empty: none are
    std::vector<std::shared_ptr<void>> kept_;
};

} // namespace evod::command_line
