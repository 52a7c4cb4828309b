// `evod token`: creates, lists and revokes tokens. A running server reads the changed token file within a second.
#include "proto/command_line/command.h"
#include "server/access/token_file.h"
#include "server/commands/commands.h"
#include "server/commands/common_options.h"

#include <cstdio>
#include <iostream>
#include <string>

namespace evod::commands {
namespace {

struct TokenOptions {
    std::string folder, name, role;
};

/// Prints only the token to stdout, so that a script can store it. Prints to stderr how to use the token.
int add_token(const TokenOptions& options) {
    const access::Role role = *access::role_named(options.role);
    const auto secret = access::add_token(options.folder, options.name, role);
    if (!secret) {
        return fail(secret.error());
    }
    std::cerr << "token of " << options.name << ", role " << access::name_of(role)
              << ": it cannot be printed again; evoctl and evoview read it from the environment variable EVOD_TOKEN or "
                 "from the file given with --token-file\n";
    std::cout << *secret << std::endl;
    return 0;
}

int list_tokens(const TokenOptions& options) {
    const auto tokens = access::read_tokens(options.folder);
    if (!tokens) {
        return fail(tokens.error());
    }
    if (tokens->empty()) {
        std::cerr << "evod: there are no tokens in " << options.folder
                  << ": create one with evod token add NAME --role ROLE\n";
    }
    std::printf("%-24s %-10s %s\n", "NAME", "ROLE", "CREATED ON");
    for (const access::Token& token : *tokens) {
        std::printf("%-24s %-10s %s\n", token.name.c_str(), access::name_of(token.role), token.created_on.c_str());
    }
    return 0;
}

int revoke_token(const TokenOptions& options) {
    if (const auto revoked = access::revoke_token(options.folder, options.name); !revoked) {
        return fail(revoked.error());
    }
    return 0;
}

} // namespace

void add_token_command(command_line::Command& app) {
    auto& token =
        app.add_command("token", "Create, list and revoke the tokens of clients on other machines").group("Access");
    auto& options = token.keep(TokenOptions{});
    const auto set_up = [&options](command_line::Command& command, int (*act)(const TokenOptions&)) {
        command.add_option("--data", &options.folder,
                           "Data folder of the server; default: $XDG_STATE_HOME/evod or ~/.local/state/evod");
        command.action([&options, act] { return find_data_folder(options.folder) ? act(options) : exit_error; });
    };

    auto& add = token.add_command("add", "Create a token and print it; it cannot be printed again");
    add.add_option("name", &options.name, "Name of the user, 1 to 64 characters of a-z A-Z 0-9 _ - .").required();
    add.add_option("--role", &options.role,
                   "Role of the user. viewer: may view worlds; teacher: may also create classes and control their "
                   "worlds; controller: may also run worlds and set parameters; admin: "
                   "may also create and delete worlds, and shut the server down")
        .required()
        .choices({"viewer", "teacher", "controller", "admin"});
    set_up(add, add_token);

    auto& list = token.add_command("list", "Print the names and roles of all tokens");
    set_up(list, list_tokens);

    auto& revoke = token.add_command("revoke", "Revoke a token; the server ends all sessions that use it");
    revoke.add_option("name", &options.name, "Name of the user").required();
    set_up(revoke, revoke_token);
}

} // namespace evod::commands
