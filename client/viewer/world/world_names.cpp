#include "client/viewer/world/world_names.h"

#include <algorithm>

namespace evod::viewer {

namespace {

constexpr std::size_t name_bytes_max = 64; // allowed by the server

bool is_digit(char sign) {
    return sign >= '0' && sign <= '9';
}

} // namespace

std::string unused_name(std::string_view base, std::span<const std::string> used) {
    const auto free = [&](std::string_view name) { return std::ranges::find(used, name) == used.end(); };
    if (free(base)) {
        return std::string{base};
    }
    std::size_t digits = base.size();
    while (digits > 0 && is_digit(base[digits - 1])) {
        --digits;
    }
    if (digits > 1 && digits < base.size() && base[digits - 1] == '-') {
        base = base.substr(0, digits - 1);
    }
    for (std::size_t number = 2;; ++number) {
        const std::string end = "-" + std::to_string(number);
        const std::string name = std::string{base.substr(0, name_bytes_max - end.size())} + end;
        if (free(name)) {
            return name;
        }
    }
}

} // namespace evod::viewer
