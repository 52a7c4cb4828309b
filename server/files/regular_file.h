// Regular file: opens and reads files that a user names or that others may have put there. A pipe, which would be
// waited for, and a device, which may have no end, are refused at once; a file is read up to a number of bytes.
//
// Threads  any; each object on one.
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
    /// kind  what it should be, as a message says it: "an experiment file".
    ///
    /// Refused with the path in the message: NotFound if there is no such file, InvalidArgument if it is a folder, a
    /// pipe, a device or a socket, otherwise Unavailable.
    static base::Result<RegularFile> open(const std::string& path, std::string_view kind,
                                          Links links = Links::Followed);

    RegularFile(RegularFile&& other) noexcept;
    RegularFile& operator=(RegularFile&&) = delete;
    ~RegularFile();

    /// As it was when it was opened.
    const struct stat& about() const { return about_; }
    /// All of it. Refused as InvalidArgument if it has more bytes.
    base::Result<std::string> read(std::size_t bytes_max) const;
    /// Fills `bytes` from that offset. Returns how many there were before the end of the file, or a failure to read.
    std::size_t read_at(std::uint64_t offset, std::span<std::byte> bytes) const;

  private:
    RegularFile(std::string path, std::string_view kind, int descriptor, const struct stat& about)
        : path_{std::move(path)}, kind_{kind}, descriptor_{descriptor}, about_{about} {}

    std::string path_, kind_;
    int descriptor_;
    struct stat about_;
};

/// The same in one step.
base::Result<std::string> read_file(const std::string& path, std::string_view kind, std::size_t bytes_max);

/// What there is instead of a regular file: "a folder", "a pipe", "a device", "a socket", "a link"; empty for one.
std::string_view other_than_file(mode_t mode);

} // namespace evod::files
