#include "server/access/random.h"

#include "server/base/assert.h"

#include <openssl/rand.h>

namespace evod::access {

std::uint64_t draw_random() {
    std::uint64_t bits = 0;
    const bool drawn = RAND_bytes(reinterpret_cast<unsigned char*>(&bits), sizeof bits) == 1;
    EVOD_ASSERT(drawn); // it fails only if the system provides no random numbers at all
    return bits;
}

} // namespace evod::access
