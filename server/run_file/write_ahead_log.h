// Write-ahead log: distinguishes a damaged log, NAME.evod-wal, from a log whose last write was torn by a crash.
//
// SQLite recovers the frames of a log up to the first frame with a wrong checksum, and silently drops all later frames.
// This is right after a torn write. But a flipped bit in the middle of a log has the same effect, and acknowledged
// commands would be lost. So this code also reads the frames after the bad one. Each of two facts proves that
// the bad frame had been on the disk:
//
//   - A later frame continues the checksum of a commit at or after the bad frame. SQLite writes such a frame only after
//     that commit, and everything before it, has been synced.
//   - The index next to the log, NAME.evod-shm, counts the bad frame. SQLite updates the index after a commit was
//     synced.
//
// After the last valid frame there may be frames of earlier cycles of the log, which have other salts, and frames of a
// transaction that was rolled back. A truncated log counts as undamaged, because it looks like one whose last write was
// torn.
//
// Determinism  the result depends only on the bytes.
// Source       https://www.sqlite.org/fileformat2.html#walformat and https://www.sqlite.org/walformat.html
#pragma once

#include "server/base/executor.h"
#include "server/base/result.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace evod::run_file {

/// Reads bytes of a file, beginning at an offset. Returns their number, which is smaller than requested at the end of
/// the file.
using ReadAt = base::FunctionRef<std::size_t(std::uint64_t offset, std::span<std::byte> bytes)>;

/// Returns the offset of the first frame that had been on the disk and is damaged; 0 if the header of the log is
/// damaged; nullopt if the log is undamaged.
std::optional<std::uint64_t> damage_of_log(ReadAt log, ReadAt index);

enum class LogIndex { Read, Unread };

/// Returns DataLoss if the log of a run file is damaged; the message says how to accept the loss. Succeeds if there
/// is no log, and while a server writes to it.
///
/// index  LogIndex::Read is allowed only if nothing in this process has the run file open. Closing the index would
///        release the locks that SQLite holds on it for the whole process.
base::Result<void> check_log(const std::string& path_of_run_file, LogIndex index);

} // namespace evod::run_file
