// Atomic file: a file that appears complete or not at all, also after a crash of the program or the machine.
//
// It is written under a temporary name in the same folder, synced to the disk, and renamed. A file that another process
// put there meanwhile is replaced.
//
// Threads  one at a time.
#pragma once

#include "server/base/result.h"

#include <string>
#include <string_view>

namespace evod::experiments {

class AtomicFile {
  public:
    explicit AtomicFile(std::string path);
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;
    /// Removes the temporary file, unless finish() has renamed it.
    ~AtomicFile();

    /// After an error, which finish() reports, it writes nothing more.
    void write(std::string_view text);
    base::Result<void> finish();
    /// The first error; empty if there is none.
    const std::string& error() const { return error_; }

    /// A new name in the folder of `path`, different at every call and in every process.
    static std::string temporary_name(const std::string& path);
    /// Whether temporary_name() made this name.
    static bool is_temporary(std::string_view name);
    /// Syncs the contents of a file, or the names in a folder, to the disk.
    static base::Result<void> sync(const std::string& path);

  private:
    void write_out(std::string_view text);
    void note_error();

    const std::string path_, temporary_path_;
    int file_; // descriptor
    std::string buffer_, error_;
};

} // namespace evod::experiments
