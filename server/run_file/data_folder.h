// Data folder: where a server's run files lie. `NAME.evod` is the run of the world NAME; `NAME.RUNID.evod` is one that
// has ended; `NAME.evod-next` one that is being made, and then becomes `NAME.evod`.
//
// Owner        one server: a lock on the file `lock` keeps a second one out.
#pragma once

#include "server/base/result.h"
#include "server/simulation/commands.h"

#include <string>
#include <vector>

namespace evod::run_file {

class DataFolder {
  public:
    /// Makes the folder if there is none. Refused where another server has it, or it cannot be used.
    static base::Result<DataFolder> open(const std::string& path);

    DataFolder(DataFolder&& other) noexcept;
    DataFolder& operator=(DataFolder&&) = delete;
    ~DataFolder();

    const std::string& path() const { return path_; }
    std::string file_of(const std::string& world) const;
    std::string ended_file_of(const std::string& world, const simulation::RunId& run_id) const;
    static std::string next_file_of(const std::string& file) { return file + "-next"; }
    struct Files {
        std::vector<std::string> of_worlds, ended; // paths, in order
        std::vector<std::string> replaced;         // those that there is a next_file_of(), be they there or not
        std::vector<std::string> strange;          // called like run files, but by what can be no world's name
    };
    base::Result<Files> files() const;

  private:
    DataFolder(std::string path, int lock) : path_{std::move(path)}, lock_{lock} {}
    std::string path_;
    int lock_; // file descriptor
};

} // namespace evod::run_file
