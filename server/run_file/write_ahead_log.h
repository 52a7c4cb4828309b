// Write-ahead log: distinguishes a damaged log, NAME.evod-wal, from one whose last write was torn by a crash.
//
// SQLite recovers the frames of a log up to the first with a wrong checksum and drops the rest without a report. That
// is right for a torn write. A flipped bit in the middle of a log has the same effect, and acknowledged commands would
// be lost. So this file reads the frames behind the bad one, too. Two things prove that the bad frame had been on the
// disk:
//
//   - A frame continues the checksum of a commit that is not before the bad frame. SQLite writes such a frame only after
//     that commit, and everything before it, has been synced.
//   - The index beside the log, NAME.evod-shm, counts the bad frame. SQLite updates it after a commit was synced.
//
// Behind the end of a sound log there may be frames of earlier cycles of the log, which have other salts, and frames of
// a transaction that was rolled back. A truncated log counts as sound: it looks like one whose last write was torn.
//
// Determinism  a function of the bytes.
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

/// Fills `bytes` from an offset of a file; returns how many there were before its end.
using ReadAt = base::FunctionRef<std::size_t(std::uint64_t offset, std::span<std::byte> bytes)>;

/// The offset of the first frame that had been on the disk and is damaged; nothing for a sound log. 0: the log's
/// header.
std::optional<std::uint64_t> damage_of_log(ReadAt log, ReadAt index);

enum class LogIndex { Read, Unread };

/// Refused as DataLoss if the log beside a run file is damaged, with the way to accept the loss. Sound if there is
/// none, and while a server writes to it.
///
/// index  Read only where nothing in this process has the run file open: closing the index would release the locks that
///        SQLite holds on it for the whole process.
base::Result<void> check_log(const std::string& path_of_run_file, LogIndex index);

} // namespace evod::run_file
