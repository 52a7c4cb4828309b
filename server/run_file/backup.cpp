#include "server/run_file/backup.h"

#include "server/access/token_file.h"
#include "server/run_file/check.h"
#include "server/run_file/data_folder.h"
#include "server/run_file/database.h"
#include "server/run_file/run_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>
#include <set>
#include <system_error>
#include <utility>

namespace evod::run_file {
namespace {

namespace fs = std::filesystem;
using base::Refusal;
using base::RefusalCode;
using base::Result;

Refusal cannot(const std::string& act, const std::string& path, const std::string& why) {
    return refusal(RefusalCode::Unavailable, "cannot " + act + " " + path + ": " + why);
}

/// Waits until a file, or the names in a folder, are on the disk.
Result<void> sync(const std::string& path) {
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    const bool synced = descriptor >= 0 && ::fsync(descriptor) == 0;
    const int why = errno;
    if (descriptor >= 0) {
        ::close(descriptor);
    }
    if (!synced) {
        return cannot("write", path, std::strerror(why));
    }
    return {};
}

/// The device and the inode of the file that has this name now, or nothing.
std::optional<std::pair<dev_t, ino_t>> file_with_name(const std::string& path) {
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0) {
        return std::nullopt;
    }
    return std::pair{status.st_dev, status.st_ino};
}

/// A new folder next to the copy, which becomes the copy; without keep(), it is deleted with everything in it. Nothing
/// is deleted that this process has not made.
class Staging {
  public:
    static Result<Staging> next_to(const fs::path& folder) {
        std::error_code error;
        fs::create_directories(folder.parent_path(), error);
        std::string path = folder.string() + ".partial-XXXXXX";
        if (error || ::mkdtemp(path.data()) == nullptr) {
            return cannot("create", path, error ? error.message() : std::strerror(errno));
        }
        return Staging{std::move(path)};
    }
    Staging(Staging&& other) noexcept : path_{std::exchange(other.path_, {})} {}
    Staging& operator=(Staging&&) = delete;
    ~Staging() {
        std::error_code ignored;
        if (!path_.empty()) {
            fs::remove_all(path_, ignored);
        }
    }
    const std::string& path() const { return path_; }
    void keep() { path_.clear(); }

  private:
    explicit Staging(std::string path) : path_{std::move(path)} {}
    std::string path_;
};

/// Refuses a folder `data` that cannot be copied to `folder`.
Result<void> expect_apart(const std::string& data, const fs::path& folder) {
    std::error_code error;
    const fs::path source = fs::canonical(data, error);
    if (error || !fs::is_directory(source, error)) {
        return cannot("read", data, error ? error.message() : "it is not a folder");
    }
    const auto files = DataFolder::files_in(data);
    if (!files) {
        return files.error();
    }
    if (files->of_worlds.empty() && files->ended.empty() && files->replaced.empty() &&
        !fs::exists(access::token_file_of(data), error) && !fs::exists(classes_file_of(data), error)) {
        return refusal(RefusalCode::NotFound, data + " contains no runs and no tokens: is it the data folder?");
    }
    const fs::path target = fs::weakly_canonical(folder, error);
    if (std::ranges::mismatch(source, target).in1 == source.end()) {
        return refusal(RefusalCode::InvalidArgument,
                       folder.string() + " is in the data folder: name a folder outside it");
    }
    return {};
}

class Copier {
  public:
    Copier(const std::string& data, const std::string& target) : data_{data}, target_{target} {}

    Result<Backup> copy() {
        constexpr int passes_max = 3; // a reset or deletion meanwhile renames files
        for (int pass = 0; pass < passes_max; ++pass) {
            const auto files = DataFolder::files_in(data_);
            if (!files) {
                return files.error();
            }
            const std::size_t taken = taken_.size();
            for (const auto* paths : {&files->of_worlds, &files->replaced, &files->ended}) {
                for (const std::string& path : *paths) {
                    if (!taken_.insert(path).second) {
                        continue;
                    }
                    const auto copied = paths == &files->ended ? copy_ended(path) : copy_world(path);
                    if (!copied) {
                        return copied.error();
                    }
                }
            }
            if (taken_.size() == taken) {
                break;
            }
        }
        if (auto copied = copy_tokens(); !copied) {
            return copied.error();
        }
        if (auto copied = copy_classes(); !copied) {
            return copied.error();
        }
        return std::move(report_);
    }

  private:
    enum class Outcome { Missing, Renamed, Known, Failed, Ended, Live };

    /// Copies the present run of a world. If that run turns out to have ended or to have been renamed, a reset is
    /// replacing it: then the run that follows it has the name NAME.evod-next or NAME.evod.
    Result<void> copy_world(const std::string& path) {
        const std::string next = DataFolder::next_file_of(path);
        for (int misses = 0; misses < 2; ++misses) { // the second time, because of a renaming between two looks
            for (const std::string& name_now : {path, next}) {
                const auto outcome = copy_run(name_now, path);
                if (!outcome) {
                    return outcome.error();
                }
                if (*outcome == Outcome::Live || *outcome == Outcome::Failed) {
                    return {};
                }
                if (*outcome == Outcome::Ended || *outcome == Outcome::Renamed) {
                    misses = -1;
                }
            }
        }
        return {};
    }

    Result<void> copy_ended(const std::string& path) {
        const auto outcome = copy_run(path, path);
        if (!outcome) {
            return outcome.error();
        }
        return {};
    }

    /// Copies one run file, unless the run is already in the copy.
    ///
    /// path  the name that the file of a run that has not ended gets.
    Result<Outcome> copy_run(const std::string& name_now, const std::string& path) {
        const auto found = file_with_name(name_now);
        if (!found) {
            return Outcome::Missing;
        }
        auto file = RunFile::open_checked(name_now);
        const auto pinned = file ? (*file)->pin_snapshot() : file.error();
        if (file_with_name(name_now) != found) { // the log that was opened may belong to the other file
            return Outcome::Renamed;
        }
        if (!pinned) {
            const bool is_being_created = name_now != path;
            return is_being_created ? Outcome::Missing : failed(pinned.error());
        }
        const std::string run_id = to_text((*file)->identity().run_id);
        if (runs_.contains(run_id)) {
            return Outcome::Known;
        }
        const auto mark = (*file)->end_mark();
        if (!mark) {
            return failed(mark.error());
        }
        const bool has_ended = *mark && (*mark)->ended;
        std::string name = fs::path{path}.filename().string();
        if (has_ended && path.find(run_id) == std::string::npos) {
            name = world_of(path) + "." + run_id + ".evod";
        }
        const std::string copy = target_ + "/" + name;
        if (auto copied = (*file)->copy_to(copy); !copied) {
            (void)remove_run_file(copy);
            file->reset();
            const auto source = RunFile::open_read_only(name_now);
            const auto sound = source ? check(**source) : source.error();
            if (!sound) {
                return failed(sound.error());
            }
            return copied.error(); // the copy cannot be written
        }
        if (auto sound = check_copy(copy); !sound) {
            (void)remove_run_file(copy);
            if (sound.error().code != RefusalCode::DataLoss) {
                return sound.error();
            }
            Refusal why = sound.error();
            why.message = name_now + why.message.substr(std::min(copy.size(), why.message.size()));
            return failed(why);
        }
        std::error_code error;
        fs::last_write_time(copy, fs::last_write_time(name_now, error), error); // the order of runs that have ended
        runs_.insert(run_id);
        ++(has_ended ? report_.ended : report_.worlds);
        report_.bytes += fs::file_size(copy, error);
        return has_ended ? Outcome::Ended : Outcome::Live;
    }

    static Result<void> check_copy(const std::string& path) {
        auto file = RunFile::open_read_only(path);
        if (!file) {
            return file.error();
        }
        if (auto sound = check(**file); !sound) {
            return sound;
        }
        return sync(path);
    }

    Outcome failed(const Refusal& why) {
        std::string line = why.message; // SQLite describes damage in several lines
        std::ranges::replace(line, '\n', ' ');
        report_.failures.push_back(line);
        return Outcome::Failed;
    }

    Result<void> copy_tokens() {
        const std::string from = access::token_file_of(data_), to = access::token_file_of(target_);
        std::error_code error;
        const auto kind = fs::symlink_status(from, error).type();
        if (kind == fs::file_type::not_found) {
            return {};
        }
        if (kind != fs::file_type::regular) {
            failed(cannot("copy", from, "it is not a regular file"));
            return {};
        }
        fs::copy_file(from, to, error); // keeps the permissions
        if (error) {
            return cannot("copy", from, error.message());
        }
        report_.has_tokens = true;
        report_.bytes += fs::file_size(to, error);
        return sync(to);
    }

    /// Copies the classes as after their last change. Later worlds of members may be missing: a member's world is
    /// created again when the member connects.
    Result<void> copy_classes() {
        const std::string from = classes_file_of(data_), to = classes_file_of(target_);
        std::error_code error;
        if (!fs::exists(fs::symlink_status(from, error)) || fs::file_size(from, error) == 0) {
            return {};
        }
        if (auto sound = expect_file_with_one_name(from); !sound) {
            failed(sound.error());
            return {};
        }
        Database source{from, Database::Mode::Read};
        source.run("BEGIN");
        Statement checked{source, "PRAGMA quick_check(1)"};
        const bool is_sound = checked.row() && checked.text(0) == "ok";
        if (source.failed() || !is_sound) {
            failed(cannot("copy", from, source.failed() ? source.error() : "it is damaged"));
            return {};
        }
        source.copy_to(to);
        if (source.failed()) {
            return cannot("copy", from, source.error());
        }
        fs::permissions(to, fs::status(from, error).permissions(), error);
        report_.has_classes = true;
        report_.bytes += fs::file_size(to, error);
        return sync(to);
    }

    const std::string& data_;
    const std::string& target_;
    std::set<std::string> taken_, runs_; // paths of the data folder, and ids of the runs in the copy
    Backup report_;
};

} // namespace

Result<Backup> back_up(const std::string& data, const std::string& given) {
    std::error_code error;
    fs::path folder = fs::absolute(given, error).lexically_normal();
    folder = folder.has_filename() ? folder : folder.parent_path();
    const fs::file_status there = fs::symlink_status(folder, error);
    if (given.empty() || (fs::exists(there) && !(fs::is_directory(there) && fs::is_empty(folder, error)))) {
        return refusal(RefusalCode::AlreadyExists,
                       "\"" + given + "\" is not an empty folder, and not the name of a new one: name another one");
    }
    if (auto apart = expect_apart(data, folder); !apart) {
        return apart.error();
    }
    auto staging = Staging::next_to(folder);
    if (!staging) {
        return staging.error();
    }
    const std::string& partial = staging->path();
    auto backup = Copier{data, partial}.copy();
    if (!backup) {
        return backup.error();
    }
    fs::permissions(partial, fs::status(data, error).permissions(), error);
    if (auto synced = sync(partial); !synced) {
        return synced.error();
    }
    fs::rename(partial, folder, error);
    if (error) {
        return cannot("rename " + partial + " to", folder.string(), error.message());
    }
    staging->keep();
    if (auto synced = sync(folder.parent_path().string()); !synced) {
        return synced.error();
    }
    return backup;
}

} // namespace evod::run_file
