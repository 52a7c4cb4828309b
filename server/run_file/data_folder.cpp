#include "server/run_file/data_folder.h"

#include "server/simulation/world_name.h"

#include <fcntl.h>
#include <sys/file.h>
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

base::Refusal unusable(const std::string& path, const std::string& why) {
    return {.code = base::RefusalCode::Unavailable,
            .message = "the data folder " + path + " cannot be used: " + why,
            .violations = {}};
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
        return unusable(path, why == EWOULDBLOCK ? "another server is using it; give this one another with --data"
                                                 : std::strerror(why));
    }
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

base::Result<DataFolder::Files> DataFolder::files() const {
    Files files;
    std::error_code error;
    for (fs::directory_iterator file{path_, error}, end; !error && file != end; file.increment(error)) {
        const std::string name = file->path().filename().string();
        const std::string next = next_file_of(std::string{ending});
        if (name.ends_with(next) && simulation::is_world_name(name.substr(0, name.size() - next.size()))) {
            files.replaced.push_back(path_ + "/" + name.substr(0, name.size() - next.size()) + std::string{ending});
        }
        if (!name.ends_with(ending)) {
            continue;
        }
        const std::string stem = name.substr(0, name.size() - ending.size());
        const std::size_t dot = stem.find('.');
        auto& paths = dot == std::string::npos ? files.of_worlds : files.ended;
        (simulation::is_world_name(stem.substr(0, dot)) ? paths : files.strange).push_back(file->path().string());
    }
    if (error) {
        return unusable(path_, error.message());
    }
    for (std::vector<std::string>* paths : {&files.of_worlds, &files.ended, &files.replaced, &files.strange}) {
        std::sort(paths->begin(), paths->end());
    }
    return files;
}

} // namespace evod::run_file
