// New file: a file that is there whole, or not at all, however the program or the machine ends while it is written.
//
// It is written beside its place under a name of its own, put on the disk, and then given its name; what another
// process put there meanwhile is replaced.
#pragma once

#include "server/base/result.h"

#include <string>
#include <string_view>

namespace evod::experiments {

class NewFile {
  public:
    explicit NewFile(std::string path);
    NewFile(const NewFile&) = delete;
    NewFile& operator=(const NewFile&) = delete;
    /// What has not been finished is taken away.
    ~NewFile();

    /// What goes wrong is told by finish(), and nothing more is written then.
    void write(std::string_view text);
    base::Result<void> finish();
    /// Why nothing can be written; empty if nothing is wrong yet.
    const std::string& trouble() const { return trouble_; }

    /// A name beside a file's for what is to become it; another every time.
    static std::string unfinished_name(const std::string& path);
    /// Whether a file has such a name.
    static bool is_unfinished(std::string_view name);
    /// Puts a file's bytes, or a folder's names, on the disk.
    static base::Result<void> keep(const std::string& path);

  private:
    void write_out(std::string_view text);
    void note_trouble();

    const std::string path_, unfinished_;
    int file_; // descriptor
    std::string waiting_, trouble_;
};

} // namespace evod::experiments
