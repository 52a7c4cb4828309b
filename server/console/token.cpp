#include "server/console/token.h"

#include "server/access/token_file.h"

#include <cstdio>
#include <iostream>

namespace evod::console {
namespace {

int fail(const base::Refusal& refusal) {
    std::cerr << "evod token: " << base::to_text(refusal) << '\n';
    return 1;
}

} // namespace

int add_token(const std::string& folder, const std::string& name, access::Role role) {
    const auto secret = access::add_token(folder, name, role);
    if (!secret)
        return fail(secret.error());
    std::cerr << "token of " << name << ", " << access::name_of(role)
              << ", told only now; for evoctl and evoview: the environment's EVOD_TOKEN, or --token-file\n";
    std::cout << *secret << std::endl;
    return 0;
}

int list_tokens(const std::string& folder) {
    const auto tokens = access::read_tokens(folder);
    if (!tokens)
        return fail(tokens.error());
    if (tokens->empty())
        std::cerr << "evod token: there are no tokens in " << folder << ": make one with evod token add\n";
    std::printf("%-24s %-10s %s\n", "NAME", "ROLE", "MADE ON");
    for (const access::Token& token : *tokens)
        std::printf("%-24s %-10s %s\n", token.name.c_str(), access::name_of(token.role), token.made_on.c_str());
    return 0;
}

int revoke_token(const std::string& folder, const std::string& name) {
    if (const auto revoked = access::revoke_token(folder, name); !revoked)
        return fail(revoked.error());
    return 0;
}

} // namespace evod::console
