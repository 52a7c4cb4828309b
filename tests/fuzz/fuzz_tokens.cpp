// Fuzzes the token file: any text gives tokens that survive a round trip, or a refusal.
#include "server/access/token_file.h"

#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace evod::access;
    const auto tokens = parse_tokens({reinterpret_cast<const char*>(data), size});
    if (!tokens) {
        return 0;
    }
    const auto again = parse_tokens(to_text(*tokens));
    if (!again || !(*again == *tokens)) {
        std::abort();
    }
    return 0;
}
