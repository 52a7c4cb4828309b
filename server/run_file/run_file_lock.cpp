#include "server/run_file/run_file_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

namespace evod::run_file {
namespace {

using base::RefusalCode;

/// Whether the descriptor is that of the file with this path, which another program may have deleted.
bool is_still(int descriptor, const std::string& path) {
    struct stat opened {
    }, named{};
    return ::fstat(descriptor, &opened) == 0 && ::stat(path.c_str(), &named) == 0 && opened.st_ino == named.st_ino &&
           opened.st_dev == named.st_dev;
}

base::Refusal cannot_write(const std::string& run_file, const std::string& why) {
    return refusal(RefusalCode::Unavailable, run_file + " cannot be written: " + why);
}

} // namespace

base::Result<RunFileLock> RunFileLock::take(const std::string& run_file) {
    const std::string path = run_file + "-lock";
    const auto parent = std::filesystem::path{run_file}.parent_path();
    // The lock of a data folder; a folder without that file is not used by a server.
    const int folder = ::open((parent / "lock").c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW);
    if (folder >= 0 && ::flock(folder, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
        ::close(folder);
        return cannot_write(run_file, "a server uses its folder");
    }
    RunFileLock lock{path, -1, folder};
    do {
        if (lock.lock_ >= 0) {
            ::close(lock.lock_);
        }
        lock.lock_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW, 0644);
        if (lock.lock_ < 0) {
            return cannot_write(run_file, std::strerror(errno));
        }
        if (::flock(lock.lock_, LOCK_EX | LOCK_NB) != 0) {
            const int why = errno;
            ::close(std::exchange(lock.lock_, -1));
            return cannot_write(run_file, why == EWOULDBLOCK ? "another program is writing to it" : std::strerror(why));
        }
    } while (!is_still(lock.lock_, path));
    return lock;
}

RunFileLock::RunFileLock(RunFileLock&& other) noexcept
    : path_{std::move(other.path_)}, lock_{std::exchange(other.lock_, -1)}, folder_{std::exchange(other.folder_, -1)} {}

RunFileLock::~RunFileLock() {
    if (lock_ >= 0) {
        ::unlink(path_.c_str()); // before the lock is released, so that it is the file of this lock
        ::close(lock_);
    }
    if (folder_ >= 0) {
        ::close(folder_);
    }
}

} // namespace evod::run_file
