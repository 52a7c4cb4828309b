#include "proto/command_line/command.h"

#include "proto/command_line/options_file.h"
#include "proto/command_line/terminal.h"
#include "proto/command_line/usage_error.h"
#include "proto/command_line/words.h"

#include <CLI/CLI.hpp>

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <iostream>

namespace evod::command_line {
namespace {

/// The width of the help: that of the terminal, but neither too narrow nor too wide to read.
std::size_t help_width() {
    winsize size{};
    const bool known = ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
    return std::clamp<std::size_t>(known ? size.ws_col : 100, 60, 100);
}

/// The format of CLI11, with wrapped explanations.
class HelpFormat : public CLI::Formatter {
  public:
    HelpFormat() { column_width(26); }

    std::string make_help(const CLI::App* command, std::string name, CLI::AppFormatMode mode) const override {
        // CLI11 prints two empty lines between groups of options.
        return CLI::detail::find_and_replace(CLI::Formatter::make_help(command, name, mode), "\n\n\n", "\n\n");
    }
    std::string make_option_desc(const CLI::Option* option) const override {
        return explanation(option->get_description());
    }
    std::string make_subcommand(const CLI::App* command) const override {
        std::stringstream out;
        CLI::detail::format_help(out, command->get_name(), explanation(command->get_description()), get_column_width());
        return out.str();
    }
    std::string make_footer(const CLI::App* command) const override {
        const CLI::App* program = command->get_parent();
        while (program != nullptr && program->get_parent() != nullptr) {
            program = program->get_parent();
        }
        const std::string footer = CLI::Formatter::make_footer(command);
        return footer +
               (program != nullptr && command->get_fallthrough()
                    ? (footer.empty() ? "" : "\n") + ("Options of " + program->get_name() + " are accepted too: see " +
                                                      program->get_name() + " --help\n")
                    : "");
    }

  private:
    std::string explanation(const std::string& text) const { return wrapped(text, help_width() - get_column_width()); }
};

/// "evod run" for the subcommand run.
std::string words_of(const CLI::App& command) {
    return (command.get_parent() != nullptr ? words_of(*command.get_parent()) + " " : "") + command.get_name();
}

void hand_down_options(const CLI::App& program, const std::string& owner) {
    if (program.get_subcommands().empty()) {
        return;
    }
    CLI::App* command = program.get_subcommands().front();
    std::string words = program.get_name() + " " + command->get_name();
    while (!command->get_subcommands().empty()) {
        command = command->get_subcommands().front();
        words += " " + command->get_name();
    }
    for (const CLI::Option* given : program.get_options()) {
        if (given->count() == 0) {
            continue;
        }
        const std::string name = given->get_name();
        CLI::Option* own = command->get_option_no_throw(name);
        if (own == nullptr) {
            throw CLI::ValidationError{name,
                                       "an option of " + owner + " that " + words + " does not use: leave it out"};
        }
        if (own->count() > 0) {
            throw CLI::ValidationError{name, "given twice, before " + command->get_name() + " and after it"};
        }
        own->add_result(given->results());
        own->run_callback();
    }
}

} // namespace

Option Option::check(Check check) const {
    option_->check(std::move(check));
    return *this;
}

Option Option::choices(const std::vector<std::string>& choices) const {
    option_->type_name(joined(choices, "|")); // OptionDescription reads the choices from it
    option_->check([choices](const std::string& word) {
        return std::ranges::find(choices, word) != choices.end() ? std::string{}
                                                                 : "got " + word + ", allowed " + joined(choices);
    });
    return *this;
}

Option Option::count(int min, int max) const {
    option_->expected(min, max);
    return *this;
}

Option Option::one_at_a_time() const {
    option_->allow_extra_args(false);
    return *this;
}

Option Option::required() const {
    option_->required();
    return *this;
}

Option Option::needs(Option other) const {
    option_->needs(other.option_);
    return *this;
}

Option Option::excludes(Option other) const {
    option_->excludes(other.option_);
    return *this;
}

Option Option::environment(const std::string& variable) const {
    option_->envname(variable);
    return *this;
}

Option Option::show_default() const {
    option_->capture_default_str();
    return *this;
}

bool Option::is_given() const {
    return option_->count() > 0;
}

Command::Command(const std::string& name, const std::string& help, const std::string& version)
    : app_{std::make_shared<CLI::App>(help, name)}, version_{version} {
    app_->formatter(std::make_shared<HelpFormat>());
    app_->set_help_flag("-h,--help", "Print this help and exit");
    app_->set_version_flag("-V,--version", version, "Print the version and exit");
}

Option Command::add_option(const std::string& name, Target target, const std::string& help) {
    CLI::Option* const option = std::visit(
        [&](auto* variable) {
            CLI::Option* const added = app_->add_option(name, *variable, help);
            const std::string kind = added->get_type_name();
            return kind == "TEXT" ? added : added->type_name("NUMBER");
        },
        target);
    return Option{option_group_.empty() ? option : option->group(option_group_)};
}

Option Command::add_flag(const std::string& name, bool* target, const std::string& help) {
    CLI::Option* const option = app_->add_flag(name, *target, help);
    return Option{option_group_.empty() ? option : option->group(option_group_)};
}

Option Command::add_options_file(const std::string& name, const std::string& help) {
    const Option option = add_option(name, &keep(std::string{}), help);
    options_file_ = app_->get_option(name);
    return option;
}

Command& Command::add_command(const std::string& name, const std::string& help) {
    app_->require_subcommand(action_ ? 0 : 1, 1);
    commands_.push_back(Command{app_->get_subcommand_ptr(app_->add_subcommand(name, help))});
    return commands_.back().footer(""); // CLI11 would inherit the footer
}

Command& Command::group(const std::string& heading) {
    app_->group(heading);
    return *this;
}

Command& Command::environment(const std::string& variable, const std::string& effect) {
    variables_.push_back({variable, effect});
    return *this;
}

Command& Command::footer(const std::string& text) {
    app_->footer(text);
    return *this;
}

Command& Command::option_group(const std::string& heading) {
    option_group_ = heading;
    return *this;
}

Command& Command::accept_options_after_commands() {
    app_->fallthrough();
    return *this;
}

Command& Command::hand_options_down(const std::string& owner) {
    owner_ = owner;
    return *this;
}

Command& Command::set_action(std::function<int()> action) {
    action_ = std::move(action);
    app_->require_subcommand(0, 1);
    return *this;
}

std::optional<int> Command::parse(int argument_count, const char* const* arguments) {
    try {
        const std::vector<std::string> errors = read({arguments + 1, arguments + argument_count});
        return errors.empty() ? std::nullopt : std::optional{reject(joined(errors, "\n"))};
    } catch (const CLI::Success& text) {
        return app_->exit(text); // prints the help or the version
    }
}

std::vector<std::string> Command::read(const std::vector<std::string>& words) {
    const auto error_of = [this](std::vector<std::string> all) -> std::vector<std::string> {
        std::ranges::reverse(all); // CLI11 takes the last word first
        try {
            app_->parse(std::move(all));
            if (!owner_.empty()) {
                hand_down_options(*app_, owner_);
            }
            return {};
        } catch (const CLI::Success&) {
            throw;
        } catch (const CLI::ParseError& error) {
            return {text_of(error, *app_)};
        }
    };
    words_ = words;
    const std::vector<std::string> errors = error_of(words);
    if (options_file_ == nullptr || options_file_->count() != 1 || !app_->get_subcommands().empty()) {
        return errors;
    }
    // An option may be valid only together with one of the file, so the errors above may be none.
    FileOptions file = read_options_file(options_file_->results().front(), *app_, *options_file_);
    if (!file.errors.empty()) {
        return file.errors;
    }
    file.words.insert(file.words.end(), words.begin(), words.end());
    return error_of(file.words);
}

std::map<std::string, std::vector<std::string>> Command::given() const {
    std::map<std::string, std::vector<std::string>> values;
    for (const CLI::Option* option : std::as_const(*app_).get_options()) {
        if (option->count() > 0) {
            values.emplace(option->get_name(), option->results());
        }
    }
    return values;
}

int Command::run() {
    for (Command& command : commands_) {
        if (command.app_->parsed()) {
            return command.run();
        }
    }
    return action_();
}

int Command::reject(const std::string& error) const {
    print_error(app_->get_name(), error);
    std::cerr << "See " << words_of(given_parser(*app_)) << " --help\n";
    return exit_usage;
}

std::string Command::name() const {
    return app_->get_name();
}

std::string Command::help() const {
    return app_->get_description();
}

std::string Command::heading() const {
    return app_->get_group();
}

std::string Command::footer() const {
    return app_->get_footer();
}

std::string Command::help_text() const {
    return app_->get_formatter()->make_help(app_.get(), words_of(*app_), CLI::AppFormatMode::Normal);
}

const Command* Command::command(std::string_view name) const {
    const auto found = std::ranges::find(commands_, name, &Command::name);
    return found == commands_.end() ? nullptr : &*found;
}

const Command* Command::given_command() const {
    const auto found = std::ranges::find_if(commands_, [](const Command& c) { return c.app_->parsed(); });
    return found == commands_.end() ? nullptr : &*found;
}

std::vector<OptionDescription> Command::options() const {
    std::vector<OptionDescription> options;
    for (const CLI::Option* option : std::as_const(*app_).get_options()) {
        OptionDescription& description = options.emplace_back();
        for (const std::string& name : option->get_snames()) {
            description.names.push_back("-" + name);
        }
        for (const std::string& name : option->get_lnames()) {
            description.names.push_back("--" + name);
        }
        description.positional = option->get_positional() ? option->get_name(true) : "";
        description.value = option->get_items_expected_max() == 0 ? "" : option->get_type_name();
        if (description.value.find('|') != std::string::npos) {
            description.choices = CLI::detail::split(description.value, '|');
        }
        description.help = option->get_description();
        description.default_value = option->get_default_str();
        description.environment = option->get_envname();
        description.group = option->get_group();
        description.is_required = option->get_required();
        description.is_list = option->get_items_expected_max() > 1;
    }
    return options;
}

bool Command::accepts_options_of_program() const {
    return app_->get_parent() != nullptr && app_->get_fallthrough();
}

} // namespace evod::command_line
