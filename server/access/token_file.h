// Token file: stores users and their roles. The file is called `tokens` and is in the data folder. It contains a line
// for each token:
//
//   # evod tokens 1
//   NAME ROLE SHA256 DATE
//
// A token consists of 256 random bits from the operating system. evod prints it once and stores only its SHA-256. Such
// a token cannot be guessed, so a fast hash is sufficient.
//
// Safety  only the owner may be able to access the file (mode 0600), otherwise it is refused. It is replaced
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
    std::string name; // 1 to 64 characters of a-z A-Z 0-9 _ - .
    Role role = Role::Viewer;
    Digest digest{};
    std::string created_on; // date in UTC, in the form "2026-11-22"

    friend bool operator==(const Token&, const Token&) = default;
};

/// The tokens in the order of their creation. Names are unique.
using Tokens = std::vector<Token>;

/// Computes the SHA-256 of a token.
Digest digest_of(std::string_view secret);
/// Finds a token by its digest. Compares in constant time. Returns nullptr if there is no such token.
const Token* find(const Tokens& tokens, const Digest& digest);

/// Parses the text of a token file. A refusal names the invalid line.
base::Result<Tokens> parse_tokens(std::string_view text);
std::string to_text(const Tokens& tokens);

std::string token_file_of(const std::string& folder);

/// Returns no tokens if the file does not exist. Refused if it is damaged, cannot be read, or is accessible to other
/// users.
base::Result<Tokens> read_tokens(const std::string& folder);
/// Creates a token and returns its text: "evod_" and 64 hexadecimal digits. The text is not stored.
base::Result<std::string> add_token(const std::string& folder, const std::string& name, Role role);
base::Result<void> revoke_token(const std::string& folder, const std::string& name);

} // namespace evod::access
