// Input file: opens and reads files that a user names or that another user may have created. It refuses pipes, because
// reading would block, and devices, because they may have no end. The size of a read is limited.
//
// Threads  any thread; an object must be used by one thread at a time.
#pragma once

#include <boost/system/result.hpp>

#include <sys/stat.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace evod::files {

enum class Links { Followed, Refused };

/// Why a file cannot be read.
struct InputError {
    enum class Kind {
        NotFound,
        NotAFile, // a folder, pipe, device or socket
        TooLarge,
        Unreadable, // all other errors
    };
    Kind kind;
    std::string why; // without the path: "cannot be read: Permission denied", "this is a pipe, not a PEM file"
};

[[noreturn]] void throw_exception_from_error(const InputError& error, const boost::source_location& where);

template <class T>
using Input = boost::system::result<T, InputError>;

class InputFile {
  public:
    /// kind  what the file should contain, for messages: "an experiment file".
    static Input<InputFile> open(const std::string& path, std::string_view kind, Links links = Links::Followed);

    InputFile(InputFile&& other) noexcept;
    InputFile& operator=(InputFile&&) = delete;
    ~InputFile();

    /// The file's state when it was opened, including its size.
    const struct stat& about() const { return about_; }
    /// Returns the contents of the file. Refused if it has more than bytes_max bytes.
    Input<std::string> read(std::size_t bytes_max) const;
    /// Reads bytes from the given offset. Returns the number of bytes read. It is smaller than requested at the end of
    /// the file and after an error.
    std::size_t read_at(std::uint64_t offset, std::span<std::byte> bytes) const;

  private:
    InputFile(std::string_view kind, int descriptor, const struct stat& about)
        : kind_{kind}, descriptor_{descriptor}, about_{about} {}

    std::string kind_;
    int descriptor_;
    struct stat about_;
};

/// Opens a file and returns its contents.
Input<std::string> read_input(const std::string& path, std::string_view kind, std::size_t bytes_max);

/// Returns the kind of a file that is not regular: "a folder", "a pipe", "a device", "a socket", "a link". Returns an
/// empty string for a regular file.
std::string_view other_than_file(mode_t mode);

// The largest files that the programs read.
constexpr std::size_t experiment_bytes_max = 1 << 20;
constexpr std::size_t population_bytes_max = 1 << 30; // a million organisms take about 70 MB
constexpr std::size_t pem_bytes_max = 4 << 20; // all certificate authorities of a typical system take about 200 KiB
constexpr std::size_t token_bytes_max = 4096;  // the file of one token, as clients read it

} // namespace evod::files
