// Completion with values that only the server knows: names of worlds and parameters.
#include "client/ctl/caller.h"
#include "proto/command_line/completion.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace evod::ctl {

namespace {

using command_line::Candidate;
using command_line::IncompleteWord;

/// Reads the connection options from the words and the environment. Sets a short timeout, because the user is typing.
Common common_of(const std::vector<std::string>& words) {
    Common common;
    common.timeout_s = 1;
    common.may_prompt = false;
    const std::pair<const char*, std::string*> options[] = {{"--server", &common.server},
                                                            {"--token-file", &common.credentials.token_file},
                                                            {"--ca", &common.credentials.files.ca},
                                                            {"--cert", &common.credentials.files.certificate},
                                                            {"--key", &common.credentials.files.key}};
    if (const char* server = std::getenv("EVOD_SERVER")) {
        common.server = server;
    }
    if (const char* ca = std::getenv("EVOD_CA")) {
        common.credentials.files.ca = ca;
    }
    for (std::size_t i = 0; i + 1 < words.size(); ++i) {
        for (const auto& [option, value] : options) {
            if (words[i] == option) {
                *value = words[i + 1];
            }
        }
    }
    common.credentials.tls = std::ranges::find(words, "--tls") != words.end();
    return common;
}

std::vector<Candidate> parameters(const Common& common, const std::string& word, bool with_value) {
    const Registry registry = Caller{common}.registry();
    std::vector<Candidate> all;
    const auto equals = word.find('=');
    if (equals == std::string::npos || !with_value) {
        for (const auto& parameter : registry.parameters()) {
            all.push_back({parameter.name() + (with_value ? "=" : ""), parameter.help()});
        }
    } else if (const auto* parameter = registry.find(word.substr(0, equals))) {
        const std::string assigned = word.substr(0, equals + 1);
        for (const std::string& choice : parameter->choices()) {
            all.push_back({assigned + choice, ""});
        }
        if (parameter->kind() == v1::PARAMETER_KIND_FLAG) {
            all.push_back({assigned + "true", ""});
            all.push_back({assigned + "false", ""});
        }
    }
    return all;
}

std::vector<Candidate> worlds(const Common& common) {
    Caller caller{common};
    v1::Request request;
    request.mutable_list_worlds();
    const v1::Response response = caller.call(std::move(request));
    std::vector<Candidate> all;
    for (const auto& world : response.worlds().worlds()) {
        all.push_back({world.name(), sentence(world)});
    }
    for (const auto& world : response.worlds().damaged()) {
        all.push_back({world.name(), "damaged"});
    }
    return all;
}

std::vector<Candidate> classes(const Common& common) {
    Caller caller{common};
    v1::Request request;
    request.mutable_list_classes();
    const v1::Response response = caller.call(std::move(request));
    std::vector<Candidate> all;
    for (const auto& info : response.classes().classes()) {
        all.push_back({info.name(), std::to_string(info.members_size()) + " members"});
    }
    return all;
}

} // namespace

std::vector<Candidate> values_of_server(const IncompleteWord& incomplete) {
    const std::string &command = incomplete.command, &option = incomplete.option, &word = incomplete.word;
    const bool of_class = command.starts_with("class ") && command != "class create" && command != "class list";
    try {
        const Common common = common_of(incomplete.before);
        if (option == "--world" || (option.empty() && (command == "delete" || command == "fork"))) {
            return worlds(common);
        }
        if (of_class && option.empty()) {
            const bool has_name = std::ranges::find(incomplete.before, command.substr(6)) + 1 < incomplete.before.end();
            if (!has_name) {
                return classes(common);
            }
        }
        const bool assigns = command == "set" || command == "class set" || option == "--set";
        if (option == "--set" || (option.empty() && (assigns || command == "get" || command == "params"))) {
            return parameters(common, word, assigns);
        }
        if (option.empty() && command == "speed") {
            return {{"max", "as fast as the machine can"}};
        }
    } catch (const Stop&) {
        // The user is typing, and an error message would disturb the command line.
    }
    return {};
}

} // namespace evod::ctl
