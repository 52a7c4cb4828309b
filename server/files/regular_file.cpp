#include "server/files/regular_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

namespace evod::files {

using base::RefusalCode;
using base::Result;

namespace {

/// Formats a size: "1 MiB", "200 KiB", "5 bytes". Rounds down.
std::string bytes_text(std::size_t bytes) {
    return bytes >= 1 << 20   ? std::to_string(bytes >> 20) + " MiB"
           : bytes >= 1 << 10 ? std::to_string(bytes >> 10) + " KiB"
                              : std::to_string(bytes) + " bytes";
}

} // namespace

std::string_view other_than_file(mode_t mode) {
    return S_ISREG(mode)    ? ""
           : S_ISDIR(mode)  ? "a folder"
           : S_ISFIFO(mode) ? "a pipe"
           : S_ISSOCK(mode) ? "a socket"
           : S_ISLNK(mode)  ? "a link"
                            : "a device";
}

Result<RegularFile> RegularFile::open(const std::string& path, std::string_view kind, Links links) {
    const auto refused = [&](int why) {
        return refusal(why == ENOENT ? RefusalCode::NotFound : RefusalCode::Unavailable,
                       path + ": cannot be read: " + std::strerror(why));
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
        return refusal(RefusalCode::FailedPrecondition,
                       path + ": this is " + std::string{other} + ", not " + std::string{kind});
    }
    return RegularFile{path, kind, descriptor, about};
}

RegularFile::RegularFile(RegularFile&& other) noexcept
    : path_{std::move(other.path_)}
    , kind_{std::move(other.kind_)}
    , descriptor_{std::exchange(other.descriptor_, -1)}
    , about_{other.about_} {}

RegularFile::~RegularFile() {
    if (descriptor_ >= 0) {
        ::close(descriptor_);
    }
}

Result<std::string> RegularFile::read(std::size_t bytes_max) const {
    const auto too_large = [&] {
        return refusal(RefusalCode::InvalidArgument,
                       path_ + ": too large for " + kind_ + " (" + bytes_text(bytes_max) + " at most)");
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
            return refusal(RefusalCode::Unavailable, path_ + ": cannot be read: " + std::strerror(errno));
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

std::size_t RegularFile::read_at(std::uint64_t offset, std::span<std::byte> bytes) const {
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

Result<std::string> read_file(const std::string& path, std::string_view kind, std::size_t bytes_max) {
    const auto file = RegularFile::open(path, kind);
    if (!file) {
        return file.error();
    }
    return file->read(bytes_max);
}

} // namespace evod::files
