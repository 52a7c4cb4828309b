// Exported file: a copy of a run file for a client, `NAME.evod.copy-XXXXXX` in the folder of the file.
//
// Contents     everything that `evod verify` and `evod replay` need. The copy is written again row by row, so that no
//              deleted bytes remain in it. Its journal lacks the keys with which another client could send the next
//              command under the identity of a sender, and the answers that these keys would repeat.
// Removed      the names of the copies are deleted before the first byte is sent; a server that starts deletes the
//              copies of a killed one (DataFolder::open).
// Threads      the thread of the job that exports.
#pragma once

#include "server/base/stop_check.h"
#include "server/run_file/run_file.h"

#include <ostream>

namespace evod::replay {

/// Writes a copy of the pinned snapshot of a run file. Refused with UNAVAILABLE if the folder of the file cannot
/// contain the copy, and if `stop` stops the work.
///
/// only_users  the journal of the copy has the users who sent commands, but not their programs and addresses.
base::Result<void> write_exported_file(run_file::RunFile& file, bool only_users, const base::StopCheck& stop,
                                       std::ostream& out);

} // namespace evod::replay
