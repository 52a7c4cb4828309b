#include "proto/files/input_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

namespace evod::files {

namespace {

/// Formats a size: "1 MiB", "200 KiB", "5 bytes". Rounds down.
std::string bytes_text(std::size_t bytes) {
    return bytes >= 1 << 20   ? std::to_string(bytes >> 20) + " MiB"
           : bytes >= 1 << 10 ? std::to_string(bytes >> 10) + " KiB"
                              : std::to_string(bytes) + " bytes";
}

} // namespace

void throw_exception_from_error(const InputError& error, const boost::source_location&) {
    throw std::runtime_error{error.why};
}

std::string_view other_than_file(mode_t mode) {
    return S_ISREG(mode)    ? ""
           : S_ISDIR(mode)  ? "a folder"
           : S_ISFIFO(mode) ? "a pipe"
           : S_ISSOCK(mode) ? "a socket"
           : S_ISLNK(mode)  ? "a link"
                            : "a device";
}

Input<InputFile> InputFile::open(const std::string& path, std::string_view kind, Links links) {
    const auto refused = [&](int why) {
        return InputError{.kind = why == ENOENT ? InputError::Kind::NotFound : InputError::Kind::Unreadable,
                          .why = std::string{"cannot be read: "} + std::strerror(why)};
    };
    // Without O_NONBLOCK, opening a pipe would wait for a writer.
    const int descriptor =
        ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC | (links == Links::Refused ? O_NOFOLLOW : 0));
    if (descriptor < 0) {
        return refused(errno);
    }
    struct stat about {};
    if (::fstat(descriptor, &about) != 0) {
        const int why = errno;
        ::close(descriptor);
        return refused(why);
    }
    if (const std::string_view other = other_than_file(about.st_mode); !other.empty()) {
        ::close(descriptor);
        return InputError{.kind = InputError::Kind::NotAFile,
                          .why = "this is " + std::string{other} + ", not " + std::string{kind}};
    }
    return InputFile{kind, descriptor, about};
}

InputFile::InputFile(InputFile&& other) noexcept
    : kind_{std::move(other.kind_)}, descriptor_{std::exchange(other.descriptor_, -1)}, about_{other.about_} {}

InputFile::~InputFile() {
    if (descriptor_ >= 0) {
        ::close(descriptor_);
    }
}

Input<std::string> InputFile::read(std::size_t bytes_max) const {
    const auto too_large = [&] {
        return InputError{.kind = InputError::Kind::TooLarge,
                          .why = "too large for " + kind_ + " (" + bytes_text(bytes_max) + " at most)"};
    };
    if (static_cast<std::uint64_t>(about_.st_size) > bytes_max) {
        return too_large();
    }
    // The size that fstat() reports is unreliable: it is 0 for files in /proc, and a file may grow while it is read.
    std::string text;
    constexpr std::size_t block = 1 << 16;
    for (std::size_t expected = static_cast<std::size_t>(about_.st_size);; expected = 0) {
        const std::size_t had = text.size();
        text.resize(had + std::max(expected, block));
        ssize_t more = 0;
        do {
            more = ::read(descriptor_, text.data() + had, text.size() - had);
        } while (more < 0 && errno == EINTR);
        if (more < 0) {
            return InputError{.kind = InputError::Kind::Unreadable,
                              .why = std::string{"cannot be read: "} + std::strerror(errno)};
        }
        text.resize(had + static_cast<std::size_t>(more));
        if (text.size() > bytes_max) {
            return too_large();
        }
        if (more == 0) {
            return text;
        }
    }
}

std::size_t InputFile::read_at(std::uint64_t offset, std::span<std::byte> bytes) const {
    std::size_t done = 0;
    while (done < bytes.size()) {
        const ssize_t more =
            ::pread(descriptor_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(offset + done));
        if (more < 0 && errno == EINTR) {
            continue;
        }
        if (more <= 0) {
            break;
        }
        done += static_cast<std::size_t>(more);
    }
    return done;
}

Input<std::string> read_input(const std::string& path, std::string_view kind, std::size_t bytes_max) {
    const auto file = InputFile::open(path, kind);
    if (!file) {
        return file.error();
    }
    return file->read(bytes_max);
}

} // namespace evod::files
