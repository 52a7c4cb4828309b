#include "server/storage/build.h"

#include "server/storage/commit.h"

namespace evod::storage {

std::string build_text() {
    const std::string commit = EVOD_COMMIT;
    return (commit.empty() ? "" : commit + " by ") + EVOD_COMPILER;
}

} // namespace evod::storage
