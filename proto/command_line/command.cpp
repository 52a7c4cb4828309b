#include "proto/command_line/command.h"

#include <CLI/CLI.hpp>

#include <iostream>

namespace evod::command_line {
namespace {

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
    option_->check(CLI::IsMember(choices));
    return *this;
}

Option Option::count(int min, int max) const {
    option_->expected(min, max);
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
    : app_{std::make_shared<CLI::App>(help, name)} {
    app_->set_version_flag("--version", version);
}

Option Command::add_option(const std::string& name, Target target, const std::string& help) {
    return Option{std::visit([&](auto* variable) { return app_->add_option(name, *variable, help); }, target)};
}

Option Command::add_flag(const std::string& name, bool* target, const std::string& help) {
    return Option{app_->add_flag(name, *target, help)};
}

Command& Command::add_command(const std::string& name, const std::string& help) {
    app_->require_subcommand(action_ ? 0 : 1, 1);
    commands_.push_back(Command{app_->get_subcommand_ptr(app_->add_subcommand(name, help))});
    return commands_.back();
}

Command& Command::group(const std::string& heading) {
    app_->group(heading);
    return *this;
}

Command& Command::footer(const std::string& text) {
    app_->footer(text);
    return *this;
}

Command& Command::help_column(std::size_t column) {
    app_->get_formatter()->column_width(column);
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
        app_->parse(argument_count, arguments);
        if (!owner_.empty()) {
            hand_down_options(*app_, owner_);
        }
        return std::nullopt;
    } catch (const CLI::ParseError& error) {
        const int status = app_->exit(error);
        const bool is_unexpected = error.get_exit_code() == static_cast<int>(CLI::ExitCodes::ExtrasError);
        if (is_unexpected && !commands_.empty() && app_->get_subcommands().empty()) {
            std::cerr << "Commands are";
            for (const Command& command : commands_) {
                std::cerr << ' ' << command.name();
            }
            std::cerr << '\n';
        }
        return status == 0 ? 0 : exit_usage;
    }
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
    app_->exit(CLI::ValidationError{error});
    return exit_usage;
}

std::string Command::name() const {
    return app_->get_name();
}

std::vector<std::string> Command::option_names() const {
    std::vector<std::string> names;
    for (const CLI::Option* option : std::as_const(*app_).get_options()) {
        for (const std::string& name : option->get_lnames()) {
            names.push_back("--" + name);
        }
    }
    return names;
}

} // namespace evod::command_line
