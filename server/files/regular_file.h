// Regular file: opens and reads files that a user names or that another user may have created. It refuses a pipe, which
// would block, and a device, which may have no end. Reading is bounded.
//
// Threads  any; one object per thread.
#pragma once

#include "server/base/result.h"

#include <sys/stat.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace evod::files {

enum class Links { Followed, Refused };

class RegularFile {
  public:
    /// kind  what the file should be, for messages: "an experiment file".
    ///
    /// A refusal names the path. NotFound: no such file. InvalidArgument: a folder, pipe, device or socket.
    /// Unavailable: other errors.
    static base::Result<RegularFile> open(const std::string& path, std::string_view kind,
                                          Links links = Links::Followed);

    RegularFile(RegularFile&& other) noexcept;
    RegularFile& operator=(RegularFile&&) = delete;
    ~RegularFile();

    /// The size when the file was opened.
    const struct stat& about() const { return about_; }
    /// The whole file. InvalidArgument if it has more than bytes_max bytes.
    base::Result<std::string> read(std::size_t bytes_max) const;
    /// Reads into `bytes` from that offset. Returns how many bytes there were before the end of the file.
    std::size_t read_at(std::uint64_t offset, std::span<std::byte> bytes) const;

  private:
    RegularFile(std::string path, std::string_view kind, int descriptor, const struct stat& about)
        : path_{std::move(path)}, kind_{kind}, descriptor_{descriptor}, about_{about} {}

    std::string path_, kind_;
    int descriptor_;
    struct stat about_;
};

/// Opens and reads in one step.
base::Result<std::string> read_file(const std::string& path, std::string_view kind, std::size_t bytes_max);

/// The kind of a path that is not a regular file: "a folder", "a pipe", "a device", "a socket", "a link"; empty for a
/// regular file.
std::string_view other_than_file(mode_t mode);

} // namespace evod::files
