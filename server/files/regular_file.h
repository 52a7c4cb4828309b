// Regular file: opens and reads files that a user names or that another user may have created. It refuses pipes,
// because reading would block, and devices, because they may have no end. The size of a read is limited.
//
// Threads  any thread; an object must be used by one thread at a time.
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
    /// kind  what the file should contain, for messages: "an experiment file".
    ///
    /// A refusal names the path. NotFound: the file does not exist. FailedPrecondition: the path is a folder, pipe,
    /// device or socket. Unavailable: all other errors.
    static base::Result<RegularFile> open(const std::string& path, std::string_view kind,
                                          Links links = Links::Followed);

    RegularFile(RegularFile&& other) noexcept;
    RegularFile& operator=(RegularFile&&) = delete;
    ~RegularFile();

    /// The file's state when it was opened, including its size.
    const struct stat& about() const { return about_; }
    /// Returns the contents of the file. Refused with InvalidArgument if it has more than bytes_max bytes.
    base::Result<std::string> read(std::size_t bytes_max) const;
    /// Reads bytes from the given offset. Returns the number of bytes read. It is smaller than requested at the end of
    /// the file and after an error.
    std::size_t read_at(std::uint64_t offset, std::span<std::byte> bytes) const;

  private:
    RegularFile(std::string path, std::string_view kind, int descriptor, const struct stat& about)
        : path_{std::move(path)}, kind_{kind}, descriptor_{descriptor}, about_{about} {}

    std::string path_, kind_;
    int descriptor_;
    struct stat about_;
};

/// Opens a file and returns its contents.
base::Result<std::string> read_file(const std::string& path, std::string_view kind, std::size_t bytes_max);

/// Returns the kind of a file that is not regular: "a folder", "a pipe", "a device", "a socket", "a link". Returns an
/// empty string for a regular file.
std::string_view other_than_file(mode_t mode);

} // namespace evod::files
