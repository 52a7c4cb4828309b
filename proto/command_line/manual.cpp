#include "proto/command_line/manual.h"

#include "proto/command_line/command.h"
#include "proto/command_line/words.h"

#include <algorithm>
#include <cctype>
#include <string_view>
#include <vector>

namespace evod::command_line {
namespace {

/// A text as roff shows it.
std::string escaped(std::string_view text) {
    std::string result;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const bool begins_line = i == 0 || text[i - 1] == '\n';
        if (begins_line && (text[i] == '.' || text[i] == '\'')) {
            result += "\\&"; // otherwise the line would be a request
        }
        result += text[i] == '\\' ? "\\e" : text[i] == '-' ? "\\-" : std::string{text[i]};
    }
    return result;
}

std::string bold(std::string_view text) {
    return "\\fB" + escaped(text) + "\\fR";
}

std::string italic(std::string_view text) {
    return "\\fI" + escaped(text) + "\\fR";
}

/// A sentence or more, in lines that an editor shows whole.
std::string prose(const std::string& text) {
    return escaped(wrapped(text, 72)) + "\n";
}

/// Lines that begin with a blank are examples, which keep their line breaks. An empty line separates paragraphs.
std::string paragraphs(const std::string& text) {
    std::string result, paragraph;
    bool in_example = false;
    const auto end_paragraph = [&] {
        if (!paragraph.empty()) {
            result += (result.empty() ? "" : ".PP\n") + prose(paragraph);
            paragraph.clear();
        }
    };
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find('\n', begin), text.size());
        const std::string line = text.substr(begin, end - begin);
        begin = end + 1;
        const bool is_example = line.starts_with(' ');
        if (is_example || line.empty()) {
            end_paragraph();
        } else {
            paragraph += (paragraph.empty() ? "" : " ") + line;
        }
        if (is_example != in_example && (is_example || !line.empty())) {
            result += is_example ? ".RS 2\n.nf\n" : ".fi\n.RE\n";
            in_example = is_example;
        }
        if (is_example) {
            result += escaped(std::string_view{line}.substr(line.find_first_not_of(' '))) + "\n";
        }
    }
    if (in_example) {
        result += ".fi\n.RE\n";
    }
    end_paragraph();
    return result;
}

std::string usage(const Command& command, const std::string& words) {
    std::string text = bold(words) + " [" + italic("OPTIONS") + "]";
    for (const OptionDescription& option : command.options()) {
        if (!option.positional.empty()) {
            const std::string value = italic(option.positional) + (option.is_list ? " ..." : "");
            text += option.is_required ? " " + value : " [" + value + "]";
        }
    }
    return text + (command.commands().empty() ? "" : " [" + italic("COMMAND") + "]") + "\n";
}

std::string entry(const OptionDescription& option) {
    std::string text = ".TP\n";
    for (std::size_t i = 0; i < option.names.size(); ++i) {
        text += (i == 0 ? "" : ", ") + bold(option.names[i]);
    }
    if (option.names.empty()) {
        text += italic(option.positional);
    }
    if (!option.value.empty()) {
        text += (option.names.empty() ? ": " : " ") + italic(option.value) + (option.is_list ? " ..." : "");
    }
    text += "\n" + prose(option.help + ".");
    if (!option.default_value.empty()) {
        text += "Default: " + escaped(option.default_value) + ".\n";
    }
    if (option.is_required) {
        text += "Required.\n";
    }
    return text;
}

/// The options of a command; under a heading for each group, if there are several groups.
std::string options_text(const Command& command, bool with_headings) {
    const std::vector<OptionDescription> options = command.options();
    std::vector<std::string> groups;
    for (const OptionDescription& option : options) {
        if (std::ranges::find(groups, option.group) == groups.end()) {
            groups.push_back(option.group);
        }
    }
    std::string text;
    for (const std::string& group : groups) {
        text += with_headings ? ".SS \"" + escaped(group) + "\"\n" : "";
        for (const OptionDescription& option : options) {
            if (option.group == group &&
                (with_headings || std::ranges::find(option.names, "--help") == option.names.end())) {
                text += entry(option);
            }
        }
    }
    return text;
}

std::string commands_text(const Command& parent, const std::string& words) {
    std::string text;
    for (const Command& command : parent.commands()) {
        const std::string name = words + " " + command.name();
        text += ".SS \"" + escaped(name.substr(name.find(' ') + 1)) + "\"\n" + usage(command, name) + ".PP\n" +
                prose(command.help() + ".") + options_text(command, false);
        if (!command.footer().empty()) {
            text += ".PP\n" + paragraphs(command.footer());
        }
        text += commands_text(command, name);
    }
    return text;
}

/// The environment variables of the program.
std::string environment_text(const Command& program) {
    std::string text;
    for (const OptionDescription& option : program.options()) {
        if (!option.environment.empty()) {
            text += ".TP\n" + bold(option.environment) + "\nThe value of " + bold(option.names.back()) +
                    ", if the command line does not contain it.\n";
        }
    }
    for (const Command::Variable& variable : program.variables()) {
        text += ".TP\n" + bold(variable.name) + "\n" + prose(variable.effect);
    }
    return text + ".TP\n" + bold("NO_COLOR") + "\nIf it is not empty, the output contains no colours.\n";
}

} // namespace

std::string manual(const Command& program) {
    const std::string name = program.name();
    std::string title = name, summary = program.help();
    std::ranges::transform(title, title.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    if (summary.starts_with(name + ": ")) {
        summary.erase(0, name.size() + 2);
    }
    std::string text = ".TH " + title + " 1 \"\" \"" + escaped(program.version()) + "\" \"evod manual\"\n.SH NAME\n" +
                       name + " \\- " + escaped(summary) + "\n.SH SYNOPSIS\n" + usage(program, name);
    if (!program.footer().empty()) {
        text += ".SH DESCRIPTION\n" + paragraphs(program.footer());
    }
    text += ".SH OPTIONS\n" + options_text(program, true);
    if (!program.commands().empty()) {
        text += ".SH COMMANDS\n" + commands_text(program, name);
    }
    return text + ".SH ENVIRONMENT\n" + environment_text(program);
}

} // namespace evod::command_line
