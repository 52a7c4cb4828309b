#include "server/access/token_file.h"

#include "server/files/regular_file.h"

#include <openssl/crypto.h>
#include <openssl/rand.h>
#include <openssl/sha.h>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <optional>
#include <sstream>
#include <utility>

namespace evod::access {
namespace {

using base::Refusal;
using base::RefusalCode;
using base::Result;

constexpr std::string_view heading = "# evod tokens 1";
constexpr std::size_t file_bytes_max = tokens_max * 200;

Refusal cannot(const std::string& what, const std::string& path) {
    return refusal(RefusalCode::Unavailable, "cannot " + what + " " + path + ": " + std::strerror(errno));
}

bool is_token_name(std::string_view name) {
    const auto good = [](unsigned char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' ||
               c == '.';
    };
    return !name.empty() && name.size() <= token_name_bytes_max && std::ranges::all_of(name, good);
}

std::string to_hex(const Digest& bytes) {
    std::string text;
    for (const unsigned char byte : bytes) {
        for (const int digit : {byte >> 4, byte & 15}) {
            text += "0123456789abcdef"[digit];
        }
    }
    return text;
}

std::optional<Digest> from_hex(std::string_view text) {
    Digest bytes;
    if (text.size() != 2 * bytes.size()) {
        return std::nullopt;
    }
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto digit = std::string_view{"0123456789abcdef"}.find(text[i]);
        if (digit == std::string_view::npos) {
            return std::nullopt;
        }
        bytes[i / 2] = static_cast<unsigned char>(i % 2 == 0 ? digit << 4 : bytes[i / 2] | digit);
    }
    return bytes;
}

/// Owns a file descriptor and closes it; -1: none.
class Descriptor {
  public:
    explicit Descriptor(int number) : number_{number} {}
    ~Descriptor() {
        if (number_ >= 0) {
            ::close(number_);
        }
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    int operator*() const { return number_; }
    bool open() const { return number_ >= 0; }

  private:
    int number_;
};

/// Returns the date in the form "2026-11-22".
std::string today() {
    const std::time_t now = std::time(nullptr);
    std::tm day{};
    ::gmtime_r(&now, &day);
    char text[16];
    std::strftime(text, sizeof text, "%Y-%m-%d", &day);
    return text;
}

/// folder_descriptor  an open descriptor of `folder`.
Result<void> write_tokens(const std::string& folder, int folder_descriptor, const Tokens& tokens) {
    const std::string path = token_file_of(folder), next = path + "-next";
    const std::string text = to_text(tokens);
    {
        ::unlink(next.c_str()); // an interrupted process may have left this file
        const Descriptor file{::open(next.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600)};
        if (!file.open()) {
            return cannot("write", next);
        }
        errno = ENOSPC; // reported if write() writes only a part of the data
        if (::write(*file, text.data(), text.size()) != static_cast<ssize_t>(text.size()) || ::fsync(*file) != 0) {
            return cannot("write", next);
        }
    }
    if (::rename(next.c_str(), path.c_str()) != 0) {
        return cannot("replace", path);
    }
    // Without this sync, a revoked token could be valid again after a power failure.
    if (::fsync(folder_descriptor) != 0) {
        return cannot("write to", folder);
    }
    return {};
}

/// Reads the file, applies `change` and writes the file. Locks the folder, so that no other process changes the file
/// at the same time.
template <class Change>
Result<void> change_tokens(const std::string& folder, const Change& change) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    const Descriptor locked{::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
    if (!locked.open() || ::flock(*locked, LOCK_EX) != 0) {
        return cannot("open and lock", folder);
    }
    auto tokens = read_tokens(folder);
    if (!tokens) {
        return tokens.error();
    }
    if (Result<void> changed = change(*tokens); !changed) {
        return changed;
    }
    return write_tokens(folder, *locked, *tokens);
}

} // namespace

Digest digest_of(std::string_view secret) {
    Digest digest;
    SHA256(reinterpret_cast<const unsigned char*>(secret.data()), secret.size(), digest.data());
    return digest;
}

const Token* find(const Tokens& tokens, const Digest& digest) {
    const Token* found = nullptr;
    for (const Token& token : tokens) {
        if (CRYPTO_memcmp(token.digest.data(), digest.data(), digest.size()) == 0) {
            found = &token;
        }
    }
    return found;
}

std::string token_file_of(const std::string& folder) {
    return folder + "/tokens";
}

std::string to_text(const Tokens& tokens) {
    std::string text = std::string{heading} + '\n';
    for (const Token& token : tokens) {
        text += token.name + ' ' + name_of(token.role) + ' ' + to_hex(token.digest) + ' ' + token.created_on + '\n';
    }
    return text;
}

Result<Tokens> parse_tokens(std::string_view text) {
    const auto wrong = [](std::size_t line, const std::string& allowed) {
        return refusal(RefusalCode::DataLoss, "line " + std::to_string(line) + " must be " + allowed);
    };
    Tokens tokens;
    for (std::size_t number = 1; !text.empty() || number == 1; ++number) {
        const std::size_t end = text.find('\n');
        if (end == std::string_view::npos) {
            return wrong(number, "a line that ends with a line break");
        }
        const std::string line{text.substr(0, end)};
        text.remove_prefix(end + 1);
        if (number == 1) {
            if (line != heading) {
                return wrong(1, '"' + std::string{heading} + '"');
            }
            continue;
        }
        std::istringstream words{line};
        std::string name, role, digest, created_on, more;
        words >> name >> role >> digest >> created_on;
        const auto role_of = role_named(role);
        const auto bytes = from_hex(digest);
        if (!is_token_name(name) || !role_of || !bytes || created_on.empty() || created_on.size() > 10 ||
            words >> more) {
            return wrong(number, "NAME ROLE SHA256 DATE");
        }
        if (std::ranges::any_of(tokens, [&](const Token& token) { return token.name == name; })) {
            return wrong(number, "a token whose name occurs only once");
        }
        if (tokens.size() == tokens_max) {
            return wrong(number, "absent, because the limit of " + std::to_string(tokens_max) + " tokens is reached");
        }
        tokens.push_back({name, *role_of, *bytes, created_on});
    }
    return tokens;
}

Result<Tokens> read_tokens(const std::string& folder) {
    const std::string path = token_file_of(folder);
    const auto file = files::RegularFile::open(path, "a token file", files::Links::Refused);
    if (!file) {
        return file.error().code == RefusalCode::NotFound ? Result<Tokens>{Tokens{}} : file.error();
    }
    const struct stat& about = file->about();
    if (about.st_uid != ::geteuid() || (about.st_mode & 077) != 0) {
        return refusal(RefusalCode::FailedPrecondition,
                       path +
                           " is refused, because other users own it or can access it: chown it to the user that runs "
                           "evod, and chmod it to 600");
    }
    const auto text = file->read(file_bytes_max);
    if (!text) {
        return text.error();
    }
    auto tokens = parse_tokens(*text);
    if (!tokens) {
        return refusal(tokens.error().code, path + " is damaged: " + tokens.error().message);
    }
    return tokens;
}

Result<std::string> add_token(const std::string& folder, const std::string& name, Role role) {
    if (!is_token_name(name)) {
        return refusal(RefusalCode::InvalidArgument,
                       "name: got \"" + name + "\", allowed 1 to 64 characters of a-z A-Z 0-9 _ - .");
    }
    Digest drawn;
    if (RAND_bytes(drawn.data(), static_cast<int>(drawn.size())) != 1) {
        return refusal(RefusalCode::Unavailable, "the system provides no random numbers");
    }
    const std::string secret = "evod_" + to_hex(drawn);
    const auto added = change_tokens(folder, [&](Tokens& tokens) -> Result<void> {
        if (std::ranges::any_of(tokens, [&](const Token& token) { return token.name == name; })) {
            return refusal(RefusalCode::AlreadyExists,
                           "a token named " + name + " exists already: revoke it, or choose another name");
        }
        if (tokens.size() >= tokens_max) {
            return refusal(RefusalCode::ResourceExhausted,
                           "the limit of " + std::to_string(tokens_max) + " tokens is reached: revoke one first");
        }
        tokens.push_back({name, role, digest_of(secret), today()});
        return {};
    });
    if (!added) {
        return added.error();
    }
    return secret;
}

Result<void> revoke_token(const std::string& folder, const std::string& name) {
    return change_tokens(folder, [&](Tokens& tokens) -> Result<void> {
        if (std::erase_if(tokens, [&](const Token& token) { return token.name == name; }) == 0) {
            return refusal(RefusalCode::NotFound, "there is no token named \"" + name + '"');
        }
        return {};
    });
}

} // namespace evod::access
