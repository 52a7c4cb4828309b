#include "server/base/state_hash.h"

#include <cstdio>

namespace evod::base {

std::string to_text(const StateHash& hash) {
    char text[33];
    std::snprintf(text, sizeof text, "%016llx%016llx", static_cast<unsigned long long>(hash.high),
                  static_cast<unsigned long long>(hash.low));
    return text;
}

} // namespace evod::base
