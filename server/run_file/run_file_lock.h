// Run file lock: keeps two programs from writing to a run file outside a data folder.
//
// The lock is a file next to the run file, `NAME.evod-lock`, which is deleted when the lock is released. If the folder
// is the data folder of a server, the lock also keeps servers from using it.
//
// Owner        the program that writes to the run file.
#pragma once

#include "server/base/result.h"

#include <string>

namespace evod::run_file {

class RunFileLock {
  public:
    /// Refused if another program holds the lock, or if a server uses the folder.
    static base::Result<RunFileLock> take(const std::string& run_file);

    RunFileLock(RunFileLock&& other) noexcept;
    RunFileLock& operator=(RunFileLock&&) = delete;
    ~RunFileLock();

  private:
    RunFileLock(std::string path, int lock, int folder) : path_{std::move(path)}, lock_{lock}, folder_{folder} {}

    std::string path_;
    int lock_, folder_; // file descriptors; -1: none
};

} // namespace evod::run_file
