// Atomic file: writes a file that appears either complete or not at all, even after a crash of the program or the
// machine.
//
// The file is written under a temporary name in the same folder, synced to the disk and then renamed. If another
// process has meanwhile created a file with the final name, that file is replaced.
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
    /// Deletes the temporary file, unless finish() has renamed it.
    ~AtomicFile();

    /// Appends text. After an error, writes nothing more; finish() reports the error.
    void write(std::string_view text);
    base::Result<void> finish();
    /// The first error; empty if there is none.
    const std::string& error() const { return error_; }

    /// Returns a new temporary path in the folder of `path`. It is different for every call and every process.
    static std::string temporary_name(const std::string& path);
    /// Whether the name was returned by temporary_name().
    static bool is_temporary(std::string_view name);
    /// Syncs a file, or the list of names in a folder, to the disk.
    static base::Result<void> sync(const std::string& path);

  private:
    void write_out(std::string_view text);
    void note_error();

    const std::string path_, temporary_path_;
    int file_; // file descriptor
    std::string buffer_, error_;
};

} // namespace evod::experiments
