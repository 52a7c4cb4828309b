// Regular file: an input file (`proto/files/input_file.h`) whose errors are refusals that name the path.
//
// Threads  any thread; an object must be used by one thread at a time.
#pragma once

#include "proto/files/input_file.h"
#include "server/base/result.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace evod::files {

class RegularFile {
  public:
    /// kind  what the file should contain, for messages: "an experiment file".
    ///
    /// A refusal names the path. NotFound: the file does not exist. FailedPrecondition: the path is a folder, pipe,
    /// device or socket. Unavailable: all other errors.
    static base::Result<RegularFile> open(const std::string& path, std::string_view kind,
                                          Links links = Links::Followed);

    const struct stat& about() const { return file_.about(); }
    /// Returns the contents of the file. Refused with InvalidArgument if it has more than bytes_max bytes.
    base::Result<std::string> read(std::size_t bytes_max) const;
    std::size_t read_at(std::uint64_t offset, std::span<std::byte> bytes) const { return file_.read_at(offset, bytes); }

  private:
    RegularFile(std::string path, InputFile file) : path_{std::move(path)}, file_{std::move(file)} {}

    std::string path_;
    InputFile file_;
};

/// Opens a file and returns its contents.
base::Result<std::string> read_file(const std::string& path, std::string_view kind, std::size_t bytes_max);

} // namespace evod::files
