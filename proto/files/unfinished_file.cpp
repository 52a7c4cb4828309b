#include "proto/files/unfinished_file.h"

#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <utility>

namespace evod::files {
namespace {

// A signal handler may use only memory that exists already, so the names are copied into arrays of fixed size.
struct Name {
    std::atomic<bool> taken = false, complete = false;
    std::array<char, PATH_MAX> path{};
};
std::array<Name, 32> names;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler reads it");

void delete_and_end(int signal) {
    for (const Name& name : names) {
        if (name.complete) {
            ::unlink(name.path.data());
        }
    }
    for (const Name& name : names) {
        if (name.complete) {
            ::rmdir(name.path.data()); // fails for a folder with other files, and for what unlink() has deleted
        }
    }
    std::signal(signal, SIG_DFL);
    std::raise(signal); // is delivered when this handler returns, and ends the program
}

void handle_signals() {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        struct sigaction now {};
        if (::sigaction(signal, nullptr, &now) == 0 && now.sa_handler == SIG_DFL) {
            now.sa_handler = delete_and_end;
            ::sigaction(signal, &now, nullptr);
        }
    }
}

int add_name(const std::string& path) {
    if (path.size() >= PATH_MAX) {
        return -1;
    }
    for (std::size_t index = 0; index < names.size(); ++index) {
        if (!names[index].taken.exchange(true)) {
            std::memcpy(names[index].path.data(), path.c_str(), path.size() + 1);
            names[index].complete = true;
            return static_cast<int>(index);
        }
    }
    return -1;
}

void remove_name(int index) {
    if (index >= 0) {
        Name& name = names[static_cast<std::size_t>(index)];
        name.complete = false;
        name.taken = false;
    }
}

} // namespace

DeletedBySignals::DeletedBySignals(const std::vector<std::string>& paths) {
    static std::once_flag once;
    std::call_once(once, handle_signals);
    for (const std::string& path : paths) {
        indices_.push_back(add_name(path));
    }
}

DeletedBySignals::~DeletedBySignals() {
    for (const int index : indices_) {
        remove_name(index);
    }
}

UnfinishedFile::UnfinishedFile(std::string path) : path_{std::move(path)}, temporary_path_{path_ + ".part"} {
    std::error_code error;
    if (std::filesystem::is_symlink(path_, error)) { // renaming would replace the link
        if (const auto target = std::filesystem::canonical(path_, error); !error) {
            path_ = target.string();
            temporary_path_ = path_ + ".part";
        }
    }
    struct stat about {};
    if (::stat(path_.c_str(), &about) == 0 && !S_ISREG(about.st_mode)) {
        temporary_path_ = path_;
    } else if (about.st_mode != 0 && ::access(path_.c_str(), W_OK) != 0) {
        stream_.setstate(std::ios::failbit); // a file that may not be written must not be replaced either
        return;
    } else {
        ::unlink(temporary_path_.c_str());
        deleted_by_signals_.emplace(std::vector{temporary_path_});
    }
    stream_.open(temporary_path_, std::ios::binary);
}

UnfinishedFile::~UnfinishedFile() {
    if (temporary_path_ != path_ && stream_.is_open()) {
        stream_.close();
        ::unlink(temporary_path_.c_str());
    }
}

bool UnfinishedFile::finish() {
    if (!stream_.flush()) {
        return false;
    }
    stream_.close();
    if (temporary_path_ != path_ && ::rename(temporary_path_.c_str(), path_.c_str()) != 0) {
        const int why = errno;
        ::unlink(temporary_path_.c_str());
        errno = why;
        return false;
    }
    return true;
}

} // namespace evod::files
