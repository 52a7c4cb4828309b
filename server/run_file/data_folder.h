// Data folder: the folder with the run files of one server. Lists these files, renames them and deletes them.
//
//   NAME.evod         the run of the world NAME
//   NAME.RUNID.evod   a run that has ended
//   NAME.evod-next    a run that is being created; it becomes NAME.evod
//   NAME.damaged-N.evod   the file of a damaged world that was deleted; no server reads it
//   classes.sqlite    the classes of students (classes/registry)
//
// Owner        one server. It locks the file `lock`, so that a second server for the same folder is refused.
#pragma once

#include "server/base/result.h"
#include "server/simulation/commands.h"

#include <string>
#include <vector>

namespace evod::run_file {

class DataFolder {
  public:
    /// Opens the folder, and creates it if it does not exist. Refused if another server uses it, or if this
    /// process cannot use it.
    static base::Result<DataFolder> open(const std::string& path);

    DataFolder(DataFolder&& other) noexcept;
    DataFolder& operator=(DataFolder&&) = delete;
    ~DataFolder();

    const std::string& path() const { return path_; }
    std::string file_of(const std::string& world) const;
    std::string ended_file_of(const std::string& world, const simulation::RunId& run_id) const;
    static std::string next_file_of(const std::string& file) { return file + "-next"; }
    /// Renames the files of a world to NAME.damaged-N.evod, where N is the first unused number. No thread may have them
    /// open for writing.
    base::Result<void> move_aside(const std::string& world) const;
    struct Files {
        std::vector<std::string> of_worlds, ended; // paths of the current runs of worlds, and of ended runs; sorted
        // Paths for which next_file_of(path) exists; the path itself may not exist.
        std::vector<std::string> replaced;
        std::vector<std::string> strange; // paths that end in .evod but contain no valid world name
    };
    base::Result<Files> files() const { return files_in(path_); }
    /// The files of a folder that another server may use.
    static base::Result<Files> files_in(const std::string& path);

  private:
    DataFolder(std::string path, int lock) : path_{std::move(path)}, lock_{lock} {}
    std::string path_;
    int lock_; // file descriptor
};

/// The file with the classes of students.
inline std::string classes_file_of(const std::string& folder) {
    return folder + "/classes.sqlite";
}

/// The name of the world whose run is stored in this file.
std::string world_of(const std::string& path);

/// Renames a run file and the SQLite files next to it. This thread must not have the file open. Programs that are
/// reading the file can continue. No file keeps the old name.
base::Result<void> rename_run_file(const std::string& from, const std::string& to);

/// Deletes a run file and the SQLite files next to it. No thread may have the file open.
base::Result<void> remove_run_file(const std::string& path);

/// Refuses a folder, a device, a symbolic link, and a file with a hard link. Two servers might write to a file that has
/// two names: neither sees the other's lock, and SQLite keeps a separate log for each name.
base::Result<void> expect_file_with_one_name(const std::string& path);

} // namespace evod::run_file
