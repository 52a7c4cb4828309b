#include "server/run_file/data_folder.h"

#include "server/files/regular_file.h"
#include "server/simulation/world_name.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

namespace evod::run_file {
namespace {

namespace fs = std::filesystem;
constexpr std::string_view ending = ".evod";
constexpr std::string_view aside = ".damaged-"; // between the world's name and a number

base::Refusal unusable(const std::string& path, const std::string& why) {
    return {.code = base::RefusalCode::Unavailable,
            .message = "the data folder " + path + " cannot be used: " + why,
            .violations = {}};
}

/// Deletes the copies that exports of a killed server have left.
void remove_copies(const std::string& folder) {
    const std::string mark = std::string{ending} + std::string{DataFolder::copy_mark};
    std::error_code error;
    std::vector<fs::path> copies;
    for (fs::directory_iterator file{folder, error}, end; !error && file != end; file.increment(error)) {
        const std::string name = file->path().filename().string();
        const std::size_t at = name.find(mark);
        if (at != std::string::npos && simulation::is_world_name(name.substr(0, name.find('.'))) &&
            file->is_regular_file(error)) {
            copies.push_back(file->path());
        }
    }
    for (const fs::path& copy : copies) {
        fs::remove(copy, error);
    }
}

} // namespace

base::Result<DataFolder> DataFolder::open(const std::string& path) {
    std::error_code error;
    fs::create_directories(path, error);
    if (error) {
        return unusable(path, error.message());
    }
    const std::string lock_path = path + "/lock";
    const int lock = ::open(lock_path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (lock < 0) {
        return unusable(path, std::strerror(errno));
    }
    if (flock(lock, LOCK_EX | LOCK_NB) != 0) {
        const int why = errno;
        close(lock);
        return unusable(path, why == EWOULDBLOCK ? "another server is using it; name another folder with --data"
                                                 : std::strerror(why));
    }
    remove_copies(path);
    return DataFolder{path, lock};
}

DataFolder::DataFolder(DataFolder&& other) noexcept
    : path_{std::move(other.path_)}, lock_{std::exchange(other.lock_, -1)} {}

DataFolder::~DataFolder() {
    if (lock_ >= 0) {
        close(lock_);
    }
}

std::string DataFolder::file_of(const std::string& world) const {
    return path_ + "/" + world + std::string{ending};
}

std::string DataFolder::ended_file_of(const std::string& world, const simulation::RunId& run_id) const {
    return path_ + "/" + world + "." + to_text(run_id) + std::string{ending};
}

base::Result<void> DataFolder::move_aside(const std::string& world) const {
    std::error_code ignored;
    const auto is_there = [&](const std::string& path) { return fs::exists(fs::symlink_status(path, ignored)); };
    const std::string from = file_of(world);
    std::string to;
    for (int number = 1; to.empty() || is_there(to) || is_there(next_file_of(to)); ++number) {
        to = path_ + "/" + world + std::string{aside} + std::to_string(number) + std::string{ending};
    }
    // The incomplete file goes first: if it stayed alone, the next server would take it for the world's run.
    for (const auto& [old, renamed] : {std::pair{next_file_of(from), next_file_of(to)}, std::pair{from, to}}) {
        if (!is_there(old)) {
            continue;
        }
        if (auto moved = rename_run_file(old, renamed); !moved) {
            return moved;
        }
    }
    return {};
}

base::Result<DataFolder::Files> DataFolder::files_in(const std::string& path) {
    Files files;
    std::error_code error;
    for (fs::directory_iterator file{path, error}, end; !error && file != end; file.increment(error)) {
        const std::string name = file->path().filename().string();
        const std::string next = next_file_of(std::string{ending});
        if (name.ends_with(next) && simulation::is_world_name(name.substr(0, name.size() - next.size()))) {
            files.replaced.push_back(path + "/" + name.substr(0, name.size() - next.size()) + std::string{ending});
        }
        if (!name.ends_with(ending)) {
            continue;
        }
        const std::string stem = name.substr(0, name.size() - ending.size());
        const std::size_t dot = stem.find('.');
        if (dot != std::string::npos && stem.compare(dot, aside.size(), aside) == 0) {
            continue;
        }
        auto& paths = dot == std::string::npos ? files.of_worlds : files.ended;
        (simulation::is_world_name(stem.substr(0, dot)) ? paths : files.strange).push_back(file->path().string());
    }
    if (error) {
        return unusable(path, error.message());
    }
    for (std::vector<std::string>* paths : {&files.of_worlds, &files.ended, &files.replaced, &files.strange}) {
        std::sort(paths->begin(), paths->end());
    }
    return files;
}

std::string world_of(const std::string& path) {
    return fs::path{path}.stem().string();
}

base::Result<void> rename_run_file(const std::string& from, const std::string& to) {
    std::error_code error, ignored;
    // While a program reads the file, the last commits may be in the log only. So the log gets a hard link with the new
    // name before the file is renamed, if the file system supports links.
    struct Companion {
        const char* suffix;
        bool exists = false, linked = false;
    };
    Companion companions[] = {{"-wal"}, {"-shm"}};
    for (Companion& companion : companions) {
        fs::remove(to + companion.suffix, ignored);
        companion.exists = fs::exists(from + companion.suffix, ignored);
        fs::create_hard_link(from + companion.suffix, to + companion.suffix, error);
        companion.linked = !error;
    }
    fs::rename(from, to, error);
    if (error) {
        for (const Companion& companion : companions) {
            fs::remove(to + companion.suffix, ignored);
        }
        return refusal(base::RefusalCode::Unavailable, "cannot rename " + from + " to " + to + ": " + error.message());
    }
    for (const Companion& companion : companions) {
        if (companion.exists && !companion.linked) {
            fs::rename(from + companion.suffix, to + companion.suffix, ignored);
        } else {
            fs::remove(from + companion.suffix, ignored);
        }
    }
    return {};
}

base::Result<void> remove_run_file(const std::string& path) {
    std::error_code error, ignored;
    fs::remove(path, error);
    if (error) {
        return refusal(base::RefusalCode::Unavailable, "cannot delete " + path + ": " + error.message());
    }
    for (const char* suffix : {"-wal", "-shm", "-journal"}) {
        fs::remove(path + suffix, ignored);
    }
    return {};
}

base::Result<void> expect_file_with_one_name(const std::string& path) {
    using base::RefusalCode;
    struct stat status {};
    if (::lstat(path.c_str(), &status) != 0) {
        return {}; // opening the file reports the reason
    }
    if (S_ISLNK(status.st_mode)) {
        return refusal(
            RefusalCode::InvalidArgument,
            path + " is a symbolic link, and another server may write to its target: replace the link with a copy "
                   "of the target, or name the folder of the target with --data");
    }
    if (!S_ISREG(status.st_mode)) {
        return refusal(RefusalCode::InvalidArgument,
                       path + ": this is " + std::string{files::other_than_file(status.st_mode)} + ", not a run file");
    }
    if (status.st_nlink > 1) {
        return refusal(RefusalCode::InvalidArgument,
                       path + " has a second name, a hard link, under which another server may write to it: delete "
                              "one of the two names, or replace this file with a copy");
    }
    return {};
}

} // namespace evod::run_file
