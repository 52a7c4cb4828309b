#include "proto/command_line/completion.h"

#include "proto/command_line/manual.h"
#include "proto/command_line/words.h"
#include "proto/text/suggestion.h"

#include <algorithm>
#include <iostream>
#include <string_view>

namespace evod::command_line {
namespace {

// Bash splits COMP_WORDS at '=' and ':'. The script therefore ignores COMP_WORDS and splits the line at blanks.
// Readline replaces only the text after the last '=', so the script removes the text before it from each completion.
constexpr std::string_view bash_script = R"(# Completion of PROGRAM for bash. Use it: source <(PROGRAM complete bash)
_PROGRAM() {
    local line=${COMP_LINE:0:COMP_POINT} words word current
    read -ra words <<< "$line"
    [[ $line == *[[:space:]] ]] && words+=("")
    current=${words[-1]}
    COMPREPLY=()
    while IFS=$'\t' read -r word _; do
        [[ $current == *=* && $COMP_WORDBREAKS == *=* ]] && word=${word#*=}
        COMPREPLY+=("$word")
    done < <("${words[0]}" complete -- "${words[@]:1}" 2> /dev/null)
    [[ ${#COMPREPLY[@]} -eq 1 && ${COMPREPLY[0]} == *= ]] && compopt -o nospace
}
complete -o default -F _PROGRAM PROGRAM
)";

constexpr std::string_view zsh_script = R"(#compdef PROGRAM
# Completion of PROGRAM for zsh. Use it: source <(PROGRAM complete zsh)
_PROGRAM() {
    local word help
    local -a whole open
    while IFS=$'\t' read -r word help; do
        if [[ $word == *= ]]; then
            open+=("${word//:/\\:}:$help")
        else
            whole+=("${word//:/\\:}:$help")
        fi
    done < <("${words[1]}" complete -- "${(@)words[2,CURRENT-1]}" "$PREFIX" 2> /dev/null)
    if (( $#whole + $#open )); then
        (( $#whole )) && _describe PROGRAM whole
        (( $#open )) && _describe PROGRAM open -S ''
    else
        _files
    fi
}
if [[ $funcstack[1] == _PROGRAM ]]; then
    _PROGRAM "$@"
else
    compdef _PROGRAM PROGRAM
fi
)";

constexpr std::string_view fish_script = R"(# Completion of PROGRAM for fish. Use it: PROGRAM complete fish | source
function __PROGRAM_complete
    set -l words (commandline -opc)
    set -l current (commandline -ct)
    set -l found ($words[1] complete -- $words[2..-1] "$current" 2>/dev/null)
    if test (count $found) -gt 0
        printf '%s\n' $found
    else
        __fish_complete_path "$current"
    end
end
complete -c PROGRAM -f -a '(__PROGRAM_complete)'
)";

/// An option or positional value, with the table that contains it.
const OptionDescription* find_option(const std::vector<OptionDescription>& options, const std::string& name) {
    const auto found = std::ranges::find_if(
        options, [&](const OptionDescription& o) { return std::ranges::find(o.names, name) != o.names.end(); });
    return found == options.end() ? nullptr : &*found;
}

/// Finds the subcommand, and what the last word means.
class Context {
  public:
    Context(const Command& program, std::vector<std::string> words) : program_{program}, command_{&program} {
        word_.word = words.empty() ? "" : words.back();
        if (!words.empty()) {
            words.pop_back();
        }
        word_.before = std::move(words);
        update_options();
        for (const std::string& word : word_.before) {
            take(word);
        }
        if (const auto equals = word_.word.find('='); word_.word.starts_with("--") && equals != std::string::npos) {
            prefix_ = word_.word.substr(0, equals + 1);
            word_.option = word_.word.substr(0, equals);
            word_.word.erase(0, equals + 1);
        } else if (open_option_ && !word_.word.starts_with('-')) {
            word_.option = open_option_->names.back();
        }
    }

    std::vector<Candidate> candidates(const ValueCandidates& values) const {
        std::vector<Candidate> all = unfiltered(values), fitting;
        for (Candidate& candidate : all) {
            if (candidate.text.starts_with(word_.word)) {
                candidate.text.insert(0, prefix_);
                fitting.push_back(std::move(candidate));
            }
        }
        return fitting;
    }

  private:
    void update_options() {
        options_ = command_->options();
        if (command_->accepts_options_of_program()) {
            const auto more = program_.options();
            options_.insert(options_.end(), more.begin(), more.end());
        }
    }

    void take(const std::string& word) {
        if (word.starts_with('-')) {
            const auto* option = find_option(options_, word);
            open_option_ = option != nullptr && !option->value.empty() ? std::optional{*option} : std::nullopt;
        } else if (open_option_) {
            if (!open_option_->is_list) {
                open_option_.reset();
            }
        } else if (const Command* command = command_->command(word)) {
            command_ = command;
            word_.command += (word_.command.empty() ? "" : " ") + word;
            update_options();
        } else {
            ++positionals_given_;
        }
    }

    std::vector<Candidate> unfiltered(const ValueCandidates& values) const {
        std::vector<Candidate> all;
        if (word_.option.empty() && word_.word.starts_with('-')) {
            for (const OptionDescription& option : options_) {
                for (const std::string& name : option.names) {
                    if (std::ranges::find(all, name, &Candidate::text) == all.end()) {
                        all.push_back({name, option.help});
                    }
                }
            }
            return all;
        }
        const OptionDescription* const value = wanted_value();
        for (const std::string& choice : value != nullptr ? value->choices : std::vector<std::string>{}) {
            all.push_back({choice, ""});
        }
        if (word_.option.empty()) {
            const Command& listed = word_.command == "help" ? program_ : *command_;
            for (const Command& command : listed.commands()) {
                all.push_back({command.name(), command.help()});
            }
        }
        if (values) {
            const auto more = values(word_);
            all.insert(all.end(), more.begin(), more.end());
        }
        return all;
    }

    /// The option or positional value that the word belongs to; nullptr if there is none.
    const OptionDescription* wanted_value() const {
        if (!word_.option.empty()) {
            return find_option(options_, word_.option);
        }
        const OptionDescription* last = nullptr;
        std::size_t count = 0;
        for (const OptionDescription& option : options_) {
            if (!option.positional.empty() && count++ <= positionals_given_) {
                last = &option;
            }
        }
        return last;
    }

    const Command& program_;
    const Command* command_;
    std::vector<OptionDescription> options_;       // that the command accepts
    std::optional<OptionDescription> open_option_; // the option whose value follows
    std::size_t positionals_given_ = 0;
    IncompleteWord word_;
    std::string prefix_; // "--option=", to which the candidates are appended
};

/// Prints the help of a command, given as words: {"token", "add"}. Returns the exit status.
int print_help(const Command& program, const std::vector<std::string>& words) {
    const Command* command = &program;
    for (const std::string& word : words) {
        const Command* const next = command->command(word);
        if (next == nullptr) {
            std::vector<std::string> names;
            for (const Command& subcommand : command->commands()) {
                names.push_back(subcommand.name());
            }
            return program.reject("COMMAND: got " + word + ", allowed " + joined(names) +
                                  text::did_you_mean(word, names));
        }
        command = next;
    }
    std::cout << command->help_text();
    return 0;
}

} // namespace

std::vector<Candidate> candidates(const Command& program, const std::vector<std::string>& words,
                                  const ValueCandidates& values) {
    return Context{program, words}.candidates(values);
}

std::string completion_script(const std::string& shell, const std::string& program) {
    std::string script{shell == "bash" ? bash_script : shell == "zsh" ? zsh_script : fish_script};
    constexpr std::string_view placeholder = "PROGRAM";
    for (std::size_t at = 0; (at = script.find(placeholder, at)) != std::string::npos; at += program.size()) {
        script.replace(at, placeholder.size(), program);
    }
    return script;
}

void add_help_commands(Command& program) {
    const char* const group = "Help";
    auto& help = program.add_command("help", "Print the help of a command, or of " + program.name()).group(group);
    auto& words = help.keep(std::vector<std::string>{});
    help.add_option("COMMAND", &words, "The command; default: " + program.name() + " itself");
    help.action([&] { return print_help(program, words); });

    auto& complete =
        program.add_command("complete", "Print the script with which a shell completes commands").group(group);
    auto& shell = complete.keep(std::string{});
    complete.add_option("SHELL", &shell, "The shell").required().choices(shells);
    complete.footer("Use it at once:\n  source <(" + program.name() + " complete bash)\n  source <(" + program.name() +
                    " complete zsh)\n  " + program.name() + " complete fish | source\nAn installed " + program.name() +
                    " needs no such line: its scripts are where the shells look for them.");
    complete.action([&] { std::cout << completion_script(shell, program.name()); });

    program.add_command("man", "Print the man page; view it: " + program.name() + " man | man -l -")
        .group(group)
        .action([&] { std::cout << manual(program); });
}

bool complete(const Command& program, int argument_count, const char* const* arguments, const ValueCandidates& values) {
    if (argument_count < 3 || std::string_view{arguments[1]} != "complete" || std::string_view{arguments[2]} != "--") {
        return false;
    }
    for (const Candidate& candidate : candidates(program, {arguments + 3, arguments + argument_count}, values)) {
        std::cout << candidate.text << '\t' << candidate.help << '\n';
    }
    return true;
}

} // namespace evod::command_line
