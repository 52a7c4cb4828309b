#include "proto/command_line/usage_error.h"

#include "proto/command_line/words.h"
#include "proto/text/suggestion.h"

#include <CLI/CLI.hpp>

#include <string_view>
#include <vector>

namespace evod::command_line {
namespace {

std::vector<std::string> subcommand_names(const CLI::App& command) {
    std::vector<std::string> names;
    for (const CLI::App* subcommand : command.get_subcommands([](const CLI::App*) { return true; })) {
        names.push_back(subcommand->get_name());
    }
    return names;
}

/// The names of all options that the command accepts.
std::vector<std::string> option_names(const CLI::App& command) {
    std::vector<std::string> names;
    for (const CLI::App* app = &command; app != nullptr; app = app->get_fallthrough() ? app->get_parent() : nullptr) {
        for (const CLI::Option* option : app->get_options()) {
            for (const std::string& name : option->get_lnames()) {
                names.push_back("--" + name);
            }
        }
    }
    return names;
}

std::string unexpected(const std::string& word, const CLI::App& command) {
    if (word.starts_with('-')) {
        const std::string name = word.substr(0, word.find('='));
        return name + ": unknown option" + text::did_you_mean(name, option_names(command));
    }
    const std::vector<std::string> commands = subcommand_names(command);
    if (commands.empty() || !command.get_subcommands().empty()) {
        return word + ": unexpected argument";
    }
    const std::string similar = text::did_you_mean(word, commands);
    return word + ": unknown command" + (similar.empty() ? "; commands are " + joined(commands) : similar);
}

const CLI::Option* find(const CLI::App& command, const auto& is_wanted) {
    for (const CLI::App* app = &command; app != nullptr; app = app->get_parent()) {
        for (const CLI::Option* option : app->get_options()) {
            if (is_wanted(*option)) {
                return option;
            }
        }
    }
    return nullptr;
}

/// The text for an option with too few or too many values.
std::string wrong_count(const CLI::ParseError& error, const CLI::App& command) {
    const std::string_view what = error.what();
    const auto* option =
        find(command, [&](const CLI::Option& o) { return o.get_name() == what.substr(0, what.find(':')); });
    if (option == nullptr) {
        return error.what();
    }
    const auto most = static_cast<std::size_t>(option->get_items_expected_max());
    return option->count() > most ? option->get_name() + ": got " + std::to_string(option->count()) +
                                        " values, allowed " + std::to_string(most)
                                  : missing(*option);
}

/// The text for two options of which one is without the option that it needs, or with an option that it excludes.
std::string conflict(const CLI::ParseError& error, const CLI::App& command) {
    for (const CLI::Option* option : command.get_options([](const CLI::Option* o) { return o->count() > 0; })) {
        for (const CLI::Option* other : option->get_needs()) {
            if (other->count() == 0) {
                return option->get_name() + ": allowed only with " + other->get_name();
            }
        }
        for (const CLI::Option* other : option->get_excludes()) {
            if (other->count() > 0) {
                return option->get_name() + ": not allowed with " + other->get_name();
            }
        }
    }
    return error.what();
}

} // namespace

std::string missing(const CLI::Option& option) {
    const std::string kind = option.get_type_name();
    const bool is_choice = kind.find('|') != std::string::npos;
    return option.get_name() + ": got nothing, " + (is_choice ? "allowed " + kind : "a value is required");
}

const CLI::App& given_parser(const CLI::App& program) {
    const CLI::App* app = &program;
    while (!app->get_subcommands().empty()) {
        app = app->get_subcommands().front();
    }
    return *app;
}

std::string text_of(const CLI::ParseError& error, const CLI::App& program) {
    const CLI::App& command = given_parser(program);
    const auto code = static_cast<CLI::ExitCodes>(error.get_exit_code());
    // A misspelled command is the cause of a missing one.
    if (code == CLI::ExitCodes::ExtrasError || code == CLI::ExitCodes::RequiredError) {
        if (const auto words = program.remaining(true); !words.empty()) {
            return unexpected(words.front(), command);
        }
    }
    switch (code) {
    case CLI::ExitCodes::RequiredError: {
        const auto* option = find(command, [](const CLI::Option& o) { return o.get_required() && o.count() == 0; });
        return option != nullptr ? missing(*option)
                                 : "COMMAND: got nothing, allowed " + joined(subcommand_names(command));
    }
    case CLI::ExitCodes::ArgumentMismatch:
        return wrong_count(error, command);
    case CLI::ExitCodes::ConversionError: {
        const std::string what = error.what();
        const auto* flag = find(command, [&](const CLI::Option& o) {
            return o.count() > 0 && o.get_items_expected_max() == 0 && what.find(o.get_name()) != std::string::npos;
        });
        return flag != nullptr ? flag->get_name() + ": got " + joined(flag->results()) + ", allowed no value" : what;
    }
    case CLI::ExitCodes::RequiresError:
    case CLI::ExitCodes::ExcludesError:
        return conflict(error, command);
    default:
        return error.what(); // a check of this project, which names the option and the allowed values
    }
}

} // namespace evod::command_line
