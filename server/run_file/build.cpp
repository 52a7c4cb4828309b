#include "server/run_file/build.h"

#include "server/run_file/commit.h"

namespace evod::run_file {

std::string build_text() {
    const std::string commit = EVOD_COMMIT;
    return (commit.empty() ? "" : commit + " by ") + EVOD_COMPILER;
}

} // namespace evod::run_file
