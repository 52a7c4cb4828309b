// Unfinished file: writes a file that appears under its name only when it is complete.
//
// The text goes to NAME.part, which is renamed to NAME at the end. SIGINT, SIGTERM and SIGHUP delete NAME.part before they
// end the program, unless the program handles them itself. After SIGKILL, NAME.part remains, and the next file with this
// name replaces it. A pipe or a device, such as /dev/stdout, is written directly.
//
// Threads  one at a time for each object. Signals delete the files of at most 16 objects.
#pragma once

#include <cstdio>
#include <fstream>
#include <string>

namespace evod::files {

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
    int deleted_by_signals_ = -1; // index in the list of names; -1: not in the list
};

} // namespace evod::files
