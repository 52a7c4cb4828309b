#include "server/commands/token.h"

#include "proto/command_line/command.h"
#include "server/access/token_file.h"
#include "server/commands/common_options.h"

#include <cstdio>
#include <iostream>

namespace evod::commands {
namespace {

struct TokenOptions {
    std::string folder, name, role;
};

int fail(const base::Refusal& refusal) {
    std::cerr << "evod token: " << base::to_text(refusal) << '\n';
    return 1;
}

} // namespace

int add_token(const std::string& folder, const std::string& name, access::Role role) {
    const auto secret = access::add_token(folder, name, role);
    if (!secret) {
        return fail(secret.error());
    }
    std::cerr << "token of " << name << ", " << access::name_of(role)
              << ", told only now; for evoctl and evoview: the environment's EVOD_TOKEN, or --token-file\n";
    std::cout << *secret << std::endl;
    return 0;
}

int list_tokens(const std::string& folder) {
    const auto tokens = access::read_tokens(folder);
    if (!tokens) {
        return fail(tokens.error());
    }
    if (tokens->empty()) {
        std::cerr << "evod token: there are no tokens in " << folder << ": make one with evod token add\n";
    }
    std::printf("%-24s %-10s %s\n", "NAME", "ROLE", "MADE ON");
    for (const access::Token& token : *tokens) {
        std::printf("%-24s %-10s %s\n", token.name.c_str(), access::name_of(token.role), token.made_on.c_str());
    }
    return 0;
}

int revoke_token(const std::string& folder, const std::string& name) {
    if (const auto revoked = access::revoke_token(folder, name); !revoked) {
        return fail(revoked.error());
    }
    return 0;
}

void add_token_command(command_line::Command& app) {
    auto& token = app.add_command("token", "Who may come in from other machines, and as what");
    auto& options = token.keep(TokenOptions{});
    const auto add_folder = [&](command_line::Command& command) {
        command.add_option("--data", &options.folder,
                           "Folder of the server's runs; otherwise where it keeps them by itself");
    };

    auto& add = token.add_command("add", "Make a token; it is told once, on standard output");
    add.add_option("name", &options.name, "Whose, 1 to 64 of a-z A-Z 0-9 _ - .").required();
    add.add_option("--role", &options.role,
                   "viewer: looks; controller: and runs worlds and sets parameters; admin: and makes and deletes "
                   "worlds, and shuts the server down")
        .required()
        .choices({"viewer", "controller", "admin"});
    add_folder(add);
    add.action([&] {
        return find_data_folder(options.folder)
                   ? commands::add_token(options.folder, options.name, *access::role_named(options.role))
                   : 1;
    });

    auto& list = token.add_command("list", "Names and roles of all tokens");
    add_folder(list);
    list.action([&] { return find_data_folder(options.folder) ? list_tokens(options.folder) : 1; });

    auto& revoke = token.add_command("revoke", "Make a token useless; whoever is in with it is put out");
    revoke.add_option("name", &options.name, "Whose").required();
    add_folder(revoke);
    revoke.action(
        [&] { return find_data_folder(options.folder) ? commands::revoke_token(options.folder, options.name) : 1; });
}

} // namespace evod::commands
