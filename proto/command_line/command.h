// Command line: the options and subcommands of a program, their help, and the action of each subcommand. evod, evoctl
// and evoview use this header. CLI11 parses the command line and prints the help. Only sources of this folder
// include CLI11, because including it adds seven seconds to the compile time of a source file.
//
// Owner    the main thread. Variables to which options write must outlive parse() and run(); keep() gives them the
//          lifetime of the command.
// Threads  one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace CLI {
class App;
class Option;
} // namespace CLI

namespace evod::command_line {

/// Exit status after an error in the command line.
constexpr int exit_usage = 2;

/// The variable that receives the value of an option. Its type determines how the value is parsed and how the help
/// names it. A vector accepts several values.
using Target =
    std::variant<std::string*, std::vector<std::string>*, int*, std::int64_t*, std::uint16_t*, std::uint32_t*,
                 std::uint64_t*, double*, std::optional<std::string>*, std::optional<std::uint16_t>*,
                 std::optional<std::uint32_t>*, std::optional<std::uint64_t>*, std::optional<double>*>;

/// Returns an error message for a value as the user typed it, or an empty text if the value is valid. The message is
/// printed after the name of the option.
using Check = std::function<std::string(const std::string& word)>;

/// A handle of an option or flag. It is valid as long as its command exists. Every setter returns the same handle.
class Option {
  public:
    explicit Option(CLI::Option* option) : option_{option} {}

    Option check(Check check) const;
    /// Allows only these words. The help lists them.
    Option choices(const std::vector<std::string>& choices) const;
    /// Sets the smallest and the largest number of values that a vector accepts.
    Option count(int min, int max) const;
    /// Makes a vector take one value each time the option is given. Otherwise it takes all words up to the next option.
    Option one_at_a_time() const;
    Option required() const;
    /// Rejects this option unless the other option is given too.
    Option needs(Option other) const;
    /// Rejects this option if the other option is given too.
    Option excludes(Option other) const;
    /// Names an environment variable whose value is used if the command line does not contain the option.
    Option environment(const std::string& variable) const;
    /// Makes the help show the current value of the target as the default.
    Option show_default() const;

    /// Whether the command line or the environment contained a value.
    bool is_given() const;

  private:
    CLI::Option* option_; // owned by CLI11's App
};

/// What the program knows about an option, for help texts, man pages and completions.
struct OptionDescription {
    std::vector<std::string> names;   // "-h", "--help"; empty for a value that can only be given by its position
    std::string positional;           // name of the value in the usage; empty for a pure option
    std::string value;                // kind of the value: "NUMBER", "csv|jsonl"; empty for a flag
    std::vector<std::string> choices; // the allowed words; empty if other words are allowed
    std::string help, default_value, environment, group;
    bool is_required = false, is_list = false; // is_list: several values may follow
};

/// The program or one of its subcommands.
class Command {
  public:
    /// Creates a program. version  the text that --version prints.
    Command(const std::string& name, const std::string& help, const std::string& version);
    Command(Command&&) = default;

    /// name  "--seed" for an option, "run" for a positional value, or "server,--server" for both.
    Option add_option(const std::string& name, Target target, const std::string& help);
    Option add_flag(const std::string& name, bool* target, const std::string& help);
    /// Adds an option that names a file with further options; see options_file.h. Options of the command line win over
    /// the file. Does not apply to subcommands.
    Option add_options_file(const std::string& name, const std::string& help);
    /// Adds a subcommand. The reference stays valid. The user must give a subcommand, unless this command has its own
    /// action.
    Command& add_command(const std::string& name, const std::string& help);

    /// Sets the heading under which the help of the program lists this subcommand.
    Command& group(const std::string& heading);
    /// Sets the heading under which the help lists the options that are added later.
    Command& option_group(const std::string& heading);
    /// Sets a text that the help prints after the options.
    Command& footer(const std::string& text);
    /// Describes an environment variable that replaces no option, for the man page.
    Command& environment(const std::string& variable, const std::string& effect);
    /// Also accepts options of this command after the name of a subcommand. Applies to subcommands that are added
    /// later.
    Command& accept_options_after_commands();
    /// Treats options before the name of a subcommand as if they were given to the subcommand. If the subcommand does
    /// not have such an option, the option is rejected as an option of `owner`, because it would have no effect.
    Command& hand_options_down(const std::string& owner);

    /// Sets the action of the command. It returns the exit status; an action that returns void means status 0.
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
    /// Stores a value as long as the command exists. Use it for variables to which options write and that the action
    /// reads.
    template <class Value>
    Value& keep(Value value) {
        auto kept = std::make_shared<Value>(std::move(value));
        kept_.push_back(kept);
        return *kept;
    }

    /// Parses the command line. Returns nullopt if run() may follow. Otherwise prints the help, the version or the
    /// error, and returns the exit status.
    std::optional<int> parse(int argument_count, const char* const* arguments);
    /// Parses like parse(), but returns the errors instead of printing them. The words must not ask for the help.
    std::vector<std::string> read(const std::vector<std::string>& words);
    /// The words of the last call of parse() or read().
    const std::vector<std::string>& words() const { return words_; }
    /// The values of the options that the command line or its options file contained, by name: "--port".
    std::map<std::string, std::vector<std::string>> given() const;
    /// Runs the action of the given subcommand, or of the program if none was given. Returns the exit status.
    int run();
    /// Prints an error that parse() cannot detect, in the format of parse(). Returns the exit status.
    int reject(const std::string& error) const;

    std::string name() const;
    std::string help() const;    // one sentence
    std::string heading() const; // the heading of this subcommand in the help of the program
    std::string footer() const;
    const std::string& version() const { return version_; }
    struct Variable {
        std::string name, effect;
    };
    /// The environment variables that replace no option.
    const std::vector<Variable>& variables() const { return variables_; }
    /// The text that --help prints.
    std::string help_text() const;
    const std::list<Command>& commands() const { return commands_; }
    /// Returns the subcommand with this name, or nullptr.
    const Command* command(std::string_view name) const;
    /// Returns the subcommand that the command line contained, or nullptr.
    const Command* given_command() const;
    /// The options in the order in which they were added.
    std::vector<OptionDescription> options() const;
    /// Whether options of the program are also accepted after the name of this subcommand.
    bool accepts_options_of_program() const;

  private:
    explicit Command(std::shared_ptr<CLI::App> app) : app_{std::move(app)} {}
    Command& set_action(std::function<int()> action);

    std::shared_ptr<CLI::App> app_;
    std::list<Command> commands_;
    std::function<int()> action_;
    std::string version_;      // of the program; empty for a subcommand
    std::string option_group_; // heading for the next options; empty: "Options"
    CLI::Option* options_file_ = nullptr;
    std::vector<std::string> words_;
    std::string owner_; // owner of options that are handed down; empty: none are handed down
    std::vector<Variable> variables_;
    std::vector<std::shared_ptr<void>> kept_;
};

} // namespace evod::command_line
