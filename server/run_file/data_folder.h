// Data folder: the folder with a server's run files, and renaming and deleting such files.
//
//   NAME.evod         the run of the world NAME
//   NAME.RUNID.evod   a run that has ended
//   NAME.evod-next    a run that is being created; it becomes NAME.evod
//
// Owner        one server. It locks the file `lock`, so a second server is refused.
#pragma once

#include "server/base/result.h"
#include "server/simulation/commands.h"

#include <string>
#include <vector>

namespace evod::run_file {

class DataFolder {
  public:
    /// Creates the folder if there is none. Refused if another server has it, or it cannot be used.
    static base::Result<DataFolder> open(const std::string& path);

    DataFolder(DataFolder&& other) noexcept;
    DataFolder& operator=(DataFolder&&) = delete;
    ~DataFolder();

    const std::string& path() const { return path_; }
    std::string file_of(const std::string& world) const;
    std::string ended_file_of(const std::string& world, const simulation::RunId& run_id) const;
    static std::string next_file_of(const std::string& file) { return file + "-next"; }
    struct Files {
        std::vector<std::string> of_worlds, ended; // paths, sorted
        std::vector<std::string> replaced;         // paths that have a next_file_of(), whether they exist or not
        std::vector<std::string> strange;          // end in .evod, but the rest is no name of a world
    };
    base::Result<Files> files() const;

  private:
    DataFolder(std::string path, int lock) : path_{std::move(path)}, lock_{lock} {}
    std::string path_;
    int lock_; // file descriptor
};

/// Renames a file that this thread does not have open, with SQLite's files beside it. Programs that read it continue to
/// read it, and no file is left under the old name.
base::Result<void> rename_run_file(const std::string& from, const std::string& to);

/// Deletes a file that no thread has open, with SQLite's files beside it.
base::Result<void> remove_run_file(const std::string& path);

/// Refused for a folder, a device, a symbolic link or a file with a hard link. Two servers might write to a file with two
/// names: neither sees the other's lock, and SQLite keeps a log for each name.
base::Result<void> expect_file_with_one_name(const std::string& path);

} // namespace evod::run_file
