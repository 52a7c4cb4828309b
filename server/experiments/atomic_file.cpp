#include "server/experiments/atomic_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <random>
#include <utility>

namespace evod::experiments {
namespace {

constexpr std::string_view mark = ".unfinished-";
constexpr std::size_t buffer_bytes_max = 1 << 18;

base::Refusal cannot_write(const std::string& path, const std::string& why) {
    return refusal(base::RefusalCode::Unavailable, path + " cannot be written: " + why);
}

} // namespace

std::string AtomicFile::temporary_name(const std::string& path) {
    std::random_device random; // processes on several machines may write into the same folder
    char number[17];
    std::snprintf(number, sizeof number, "%08x%08x", random(), random());
    return path + std::string{mark} + number;
}

bool AtomicFile::is_temporary(std::string_view name) {
    return name.find(mark) != std::string_view::npos;
}

base::Result<void> AtomicFile::sync(const std::string& path) {
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    // Some file systems cannot sync a folder and report EINVAL.
    const bool synced = file >= 0 && (::fsync(file) == 0 || errno == EINVAL);
    const int error = errno;
    if (file >= 0) {
        ::close(file);
    }
    if (!synced) {
        return cannot_write(path, std::strerror(error));
    }
    return {};
}

AtomicFile::AtomicFile(std::string path)
    : path_{std::move(path)}
    , temporary_path_{temporary_name(path_)}
    , file_{::open(temporary_path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666)} {
    if (file_ < 0) {
        note_error();
    }
}

AtomicFile::~AtomicFile() {
    if (file_ < 0) {
        return;
    }
    ::close(file_);
    ::unlink(temporary_path_.c_str());
}

void AtomicFile::note_error() {
    error_ = std::strerror(errno);
}

void AtomicFile::write(std::string_view text) {
    buffer_ += text;
    if (buffer_.size() >= buffer_bytes_max) {
        write_out(std::exchange(buffer_, {}));
    }
}

void AtomicFile::write_out(std::string_view text) {
    while (error_.empty() && !text.empty()) {
        const ssize_t written = ::write(file_, text.data(), text.size());
        if (written >= 0) {
            text.remove_prefix(static_cast<std::size_t>(written));
        } else if (errno != EINTR) {
            note_error();
        }
    }
}

base::Result<void> AtomicFile::finish() {
    write_out(std::exchange(buffer_, {}));
    if (error_.empty() && ::fsync(file_) != 0) {
        note_error();
    }
    if (error_.empty() && ::rename(temporary_path_.c_str(), path_.c_str()) != 0) {
        note_error();
    }
    if (!error_.empty()) {
        return cannot_write(path_, error_);
    }
    ::close(std::exchange(file_, -1));
    const std::string folder = std::filesystem::path{path_}.parent_path().string();
    return sync(folder.empty() ? "." : folder);
}

} // namespace evod::experiments
