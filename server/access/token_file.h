// Token file: who may come in, and as what. `tokens` in a folder, that of the runs, a line for each:
//
//   # evod tokens 1
//   NAME ROLE SHA256 DATE
//
// A token is 256 bits drawn by the system, told once and never stored: the file has its SHA-256. So much chance cannot
// be guessed, so nothing slower than a plain hash is needed.
//
// Safety  the file is for its owner alone (mode 0600), and is not believed otherwise. It is replaced as a whole.
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

/// In the order in which they were made; each name once.
using Tokens = std::vector<Token>;

/// Of a token as its owner has it.
Digest digest_of(std::string_view secret);
/// In a time that tells nothing about the digests; nullptr if there is none.
const Token* find(const Tokens& tokens, const Digest& digest);

/// Refused with the number of the line that is wrong.
base::Result<Tokens> parse_tokens(std::string_view text);
std::string to_text(const Tokens& tokens);

std::string token_file_of(const std::string& folder);

/// None if there is no file. Refused where it cannot be read, is damaged, or others can read or change it.
base::Result<Tokens> read_tokens(const std::string& folder);
/// Makes one. Returns its secret, "evod_" and 64 hexadecimal digits, which nobody is told again.
base::Result<std::string> add_token(const std::string& folder, const std::string& name, Role role);
base::Result<void> revoke_token(const std::string& folder, const std::string& name);

} // namespace evod::access
