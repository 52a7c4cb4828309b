// Unfinished file: writes a file that appears under its name only when it is complete.
//
// The text goes to NAME.part, which is renamed to NAME at the end. SIGINT, SIGTERM and SIGHUP delete NAME.part before
// they end the program, unless the program handles them itself. After SIGKILL, NAME.part remains, and the next file
// with this name replaces it. A pipe or a device, such as /dev/stdout, is written directly.
//
// Threads  one at a time for each object.
#pragma once

#include <cstdio>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

namespace evod::files {

/// Files and empty folders that SIGINT, SIGTERM and SIGHUP delete before they end the program, as long as the object
/// exists. Folders are deleted after all files. Objects of this type and unfinished files together can have 32 names;
/// further ones are not deleted.
class DeletedBySignals {
  public:
    explicit DeletedBySignals(const std::vector<std::string>& paths);
    DeletedBySignals(const DeletedBySignals&) = delete;
    DeletedBySignals& operator=(const DeletedBySignals&) = delete;
    ~DeletedBySignals();

  private:
    std::vector<int> indices_; // in the list of names
};

class UnfinishedFile {
  public:
    explicit UnfinishedFile(std::string path);
    UnfinishedFile(const UnfinishedFile&) = delete;
    UnfinishedFile& operator=(const UnfinishedFile&) = delete;
    /// Deletes the file, unless finish() has renamed it.
    ~UnfinishedFile();

    /// Fails from the beginning if the file cannot be created; errno then contains the reason.
    std::ostream& stream() { return stream_; }
    /// The name under which the file is written.
    const std::string& temporary_path() const { return temporary_path_; }
    /// Writes the rest, and gives the file its name. Returns false after any error; errno contains the reason.
    bool finish();

  private:
    std::string path_, temporary_path_;
    std::ofstream stream_;
    std::optional<DeletedBySignals> deleted_by_signals_; // nullopt: the file has its name from the beginning
};

} // namespace evod::files
