// Token file: users and their roles. The file is called `tokens`, is stored in the data folder and has a line per
// token:
//
//   # evod tokens 1
//   NAME ROLE SHA256 DATE
//
// A token is 256 random bits of the system. The server prints it once and stores only its SHA-256. Guessing it is
// impossible, so a fast hash is enough.
//
// Safety  the file must be accessible to its owner only (mode 0600), otherwise it is refused. It is replaced
//         atomically.
#pragma once

#include "server/access/role.h"
#include "server/base/result.h"

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace evod::access {

constexpr std::size_t token_name_bytes_max = 64;
constexpr std::size_t tokens_max = 10'000;

using Digest = std::array<unsigned char, 32>;

struct Token {
    std::string name; // 1 to 64 of a-z A-Z 0-9 _ - .
    Role role = Role::Viewer;
    Digest digest{};
    std::string made_on; // "2026-11-22"

    friend bool operator==(const Token&, const Token&) = default;
};

/// In order of creation; each name once.
using Tokens = std::vector<Token>;

/// The SHA-256 of a token.
Digest digest_of(std::string_view secret);
/// Compares in constant time. nullptr: the token is unknown.
const Token* find(const Tokens& tokens, const Digest& digest);

/// A refusal names the invalid line.
base::Result<Tokens> parse_tokens(std::string_view text);
std::string to_text(const Tokens& tokens);

std::string token_file_of(const std::string& folder);

/// Empty if there is no file. Refused if the file cannot be read, is damaged, or is accessible to other users.
base::Result<Tokens> read_tokens(const std::string& folder);
/// Creates a token. Returns its secret: "evod_" and 64 hexadecimal digits. It cannot be read again later.
base::Result<std::string> add_token(const std::string& folder, const std::string& name, Role role);
base::Result<void> revoke_token(const std::string& folder, const std::string& name);

} // namespace evod::access
