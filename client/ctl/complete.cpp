// Completion: `evoctl complete bash` prints a script for bash; the script calls `evoctl complete -- words…`.
#include "client/ctl/caller.h"
#include "proto/command_line/command.h"

#include <algorithm>
#include <cstdlib>
#include <iostream>

namespace evod::ctl {

namespace {

using command_line::Command;

// Bash splits COMP_WORDS at '=' and ':'. The script therefore ignores COMP_WORDS and splits the line at blanks. Readline
// replaces only the text after the last '=', so the script removes the text before it from each completion.
constexpr const char* bash_script = R"(# Completion of evoctl for bash. Use it: source <(evoctl complete bash)
_evoctl() {
    local line=${COMP_LINE:0:COMP_POINT} words word current
    read -ra words <<< "$line"
    [[ $line == *[[:space:]] ]] && words+=("")
    current=${words[-1]}
    COMPREPLY=()
    while IFS= read -r word; do
        [[ $current == *=* && $COMP_WORDBREAKS == *=* ]] && word=${word#*=}
        COMPREPLY+=("$word")
    done < <("${words[0]}" complete -- "${words[@]:1}" 2> /dev/null)
    [[ ${#COMPREPLY[@]} -eq 1 && ${COMPREPLY[0]} == *= ]] && compopt -o nospace
}
complete -F _evoctl evoctl
)";

/// Prints those candidates that begin with the word that the user is typing.
class Candidates {
  public:
    explicit Candidates(std::string word) : word_{std::move(word)} {}
    void add(const std::string& candidate) const {
        if (candidate.starts_with(word_)) {
            std::cout << candidate << '\n';
        }
    }

  private:
    std::string word_;
};

/// Reads the connection options from the words and the environment. Sets a short timeout, because the user is typing.
Common common_of(const std::vector<std::string>& words) {
    Common common;
    common.timeout_s = 1;
    common.may_prompt = false;
    if (const char* server = std::getenv("EVOD_SERVER")) {
        common.server = server;
    }
    for (std::size_t i = 0; i + 1 < words.size(); ++i) {
        if (words[i] == "--server") {
            common.server = words[i + 1];
        }
    }
    return common;
}

void complete_parameter(const Registry& registry, const std::string& word, bool with_value) {
    const auto equals = word.find('=');
    if (equals == std::string::npos || !with_value) {
        for (const auto& parameter : registry.parameters()) {
            Candidates{word}.add(parameter.name() + (with_value ? "=" : ""));
        }
        return;
    }
    const std::string assigned = word.substr(0, equals + 1);
    if (const auto* parameter = registry.find(word.substr(0, equals))) {
        for (const std::string& choice : parameter->choices()) {
            Candidates{word}.add(assigned + choice);
        }
        if (parameter->kind() == v1::PARAMETER_KIND_FLAG) {
            Candidates{word}.add(assigned + "true");
            Candidates{word}.add(assigned + "false");
        }
    }
}

void complete_world(const Common& common, const std::string& word) {
    Caller caller{common};
    v1::Request request;
    request.mutable_list_worlds();
    const v1::Response response = caller.call(std::move(request));
    for (const auto& world : response.worlds().worlds()) {
        Candidates{word}.add(world.name());
    }
}

void complete_options(const Command& command, const std::string& word) {
    for (const std::string& name : command.option_names()) {
        Candidates{word}.add(name);
    }
}

} // namespace

void complete(const Command& app, const std::vector<std::string>& words) {
    const std::string word = words.empty() ? "" : words.back();
    const std::vector<std::string> before{words.begin(), words.empty() ? words.end() : words.end() - 1};
    const Command* command = nullptr;
    for (std::size_t i = 0; i < before.size() && command == nullptr; ++i) {
        const bool value = i > 0 && (before[i - 1] == "--server" || before[i - 1] == "--world");
        const auto found = std::ranges::find(app.commands(), before[i], &Command::name);
        if (!value && found != app.commands().end()) {
            command = &*found;
        }
    }
    const std::string last = before.empty() ? "" : before.back();
    try {
        if (last == "--server" || last == "--experiment" || last == "--output") {
            return; // the shell itself completes hosts and files
        }
        if (last == "--world") {
            complete_world(common_of(before), word);
        } else if (word.starts_with('-')) {
            complete_options(app, word);
            if (command != nullptr) {
                complete_options(*command, word);
            }
        } else if (command == nullptr) {
            for (const Command& subcommand : app.commands()) {
                Candidates{word}.add(subcommand.name());
            }
        } else if (const std::string name = command->name();
                   name == "set" || name == "get" || name == "params" ||
                   (name == "create" && std::ranges::find(before, "--set") != before.end())) {
            complete_parameter(Caller{common_of(before)}.registry(), word, name == "set" || name == "create");
        } else if (name == "delete" || name == "fork") {
            complete_world(common_of(before), word);
        } else if (name == "speed") {
            Candidates{word}.add("max");
        } else if (name == "complete") {
            Candidates{word}.add("bash");
        }
    } catch (const Stop&) {
        // The user is typing, and an error message would disturb the command line.
    }
}

void add_complete_command(Command& app) {
    auto& command =
        app.add_command("complete", "Print the completion script of a shell; use it: source <(evoctl complete bash)");
    command.group("Shell");
    command.add_option("SHELL", &command.keep(std::string{}), "The shell; only bash is supported")
        .required()
        .choices({"bash"});
    command.action([] { std::cout << bash_script; });
}

} // namespace evod::ctl
