#include "server/classes/codes.h"

#include <openssl/crypto.h>

namespace evod::classes {

std::string code_of(std::uint64_t random, std::size_t count) {
    std::string letters;
    for (; letters.size() < count; random /= code_letters.size()) {
        letters += code_letters[random % code_letters.size()];
    }
    return letters;
}

std::optional<std::string> normalised_code(std::string_view given) {
    std::string letters;
    for (const char c : given) {
        if (c == ' ' || c == '-') {
            continue;
        }
        const char upper = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
        if (code_letters.find(upper) == std::string_view::npos || letters.size() == personal_code_letters) {
            return std::nullopt;
        }
        letters += upper;
    }
    if (letters.size() != class_code_letters && letters.size() != personal_code_letters) {
        return std::nullopt;
    }
    return letters;
}

bool same_code(std::string_view a, std::string_view b) {
    return a.size() == b.size() && CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0;
}

} // namespace evod::classes
