#include "server/experiments/new_file.h"

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
constexpr std::size_t waiting_bytes_max = 1 << 18;

base::Refusal cannot_write(const std::string& path, const std::string& why) {
    return refusal(base::RefusalCode::Unavailable, path + " cannot be written: " + why);
}

} // namespace

std::string NewFile::unfinished_name(const std::string& path) {
    std::random_device random; // other processes, on other machines, may be writing beside
    char number[17];
    std::snprintf(number, sizeof number, "%08x%08x", random(), random());
    return path + std::string{mark} + number;
}

bool NewFile::is_unfinished(std::string_view name) {
    return name.find(mark) != std::string_view::npos;
}

base::Result<void> NewFile::keep(const std::string& path) {
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    // A file system that cannot do it to a folder says so, and has done what it can.
    const bool kept = file >= 0 && (::fsync(file) == 0 || errno == EINVAL);
    const int error = errno;
    if (file >= 0) {
        ::close(file);
    }
    if (!kept) {
        return cannot_write(path, std::strerror(error));
    }
    return {};
}

NewFile::NewFile(std::string path)
    : path_{std::move(path)}
    , unfinished_{unfinished_name(path_)}
    , file_{::open(unfinished_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666)} {
    if (file_ < 0) {
        note_trouble();
    }
}

NewFile::~NewFile() {
    if (file_ < 0) {
        return;
    }
    ::close(file_);
    ::unlink(unfinished_.c_str());
}

void NewFile::note_trouble() {
    trouble_ = std::strerror(errno);
}

void NewFile::write(std::string_view text) {
    waiting_ += text;
    if (waiting_.size() >= waiting_bytes_max) {
        write_out(std::exchange(waiting_, {}));
    }
}

void NewFile::write_out(std::string_view text) {
    while (trouble_.empty() && !text.empty()) {
        const ssize_t written = ::write(file_, text.data(), text.size());
        if (written >= 0) {
            text.remove_prefix(static_cast<std::size_t>(written));
        } else if (errno != EINTR) {
            note_trouble();
        }
    }
}

base::Result<void> NewFile::finish() {
    write_out(std::exchange(waiting_, {}));
    if (trouble_.empty() && ::fsync(file_) != 0) {
        note_trouble();
    }
    if (trouble_.empty() && ::rename(unfinished_.c_str(), path_.c_str()) != 0) {
        note_trouble();
    }
    if (!trouble_.empty()) {
        return cannot_write(path_, trouble_);
    }
    ::close(std::exchange(file_, -1));
    const std::string folder = std::filesystem::path{path_}.parent_path().string();
    return keep(folder.empty() ? "." : folder);
}

} // namespace evod::experiments
