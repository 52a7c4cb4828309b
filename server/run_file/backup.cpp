#include "server/run_file/backup.h"

#include "server/access/token_file.h"
#include "server/run_file/check.h"
#include "server/run_file/data_folder.h"
#include "server/run_file/run_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <optional>
#include <set>
#include <system_error>

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

/// Deletes what an interrupted backup has left. Refused if the folder contains anything else.
Result<void> clear(const std::string& folder) {
    std::error_code error;
    std::vector<fs::path> left;
    for (fs::directory_iterator file{folder, error}, end; !error && file != end; file.increment(error)) {
        const std::string name = file->path().filename().string();
        if (name != "tokens" && name != "lock" && name.find(".evod") == std::string::npos) {
            return refusal(RefusalCode::FailedPrecondition,
                           folder + " contains " + name + ", which is not from a backup: move it away");
        }
        if (name != "lock") {
            left.push_back(file->path());
        }
    }
    for (const fs::path& path : left) {
        fs::remove(path, error);
    }
    if (error) {
        return cannot("clear", folder, error.message());
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
        return std::move(report_);
    }

  private:
    enum class Outcome { Missing, Known, Failed, Ended, Live };

    /// Copies the present run of a world. If that run turns out to have ended, a reset is replacing it: then the run
    /// that follows it has the name NAME.evod-next or NAME.evod.
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
                if (*outcome == Outcome::Ended) {
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
        auto file = RunFile::open_checked(name_now);
        if (!file) {
            const bool is_being_created = name_now != path;
            std::error_code error;
            if (is_being_created || file.error().code == RefusalCode::NotFound) {
                return Outcome::Missing;
            }
            return failed(file.error());
        }
        if (auto pinned = (*file)->pin_snapshot(); !pinned) {
            return failed(pinned.error());
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
        report_.failures.push_back(why.message);
        return Outcome::Failed;
    }

    Result<void> copy_tokens() {
        const std::string from = access::token_file_of(data_), to = access::token_file_of(target_);
        std::error_code error;
        fs::copy_file(from, to, error); // keeps the permissions
        if (error == std::errc::no_such_file_or_directory) {
            return {};
        }
        if (error) {
            return cannot("copy", from, error.message());
        }
        report_.has_tokens = true;
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
    const bool is_there = fs::exists(fs::symlink_status(folder, error));
    if (is_there && !(fs::is_directory(folder, error) && fs::is_empty(folder, error))) {
        return refusal(RefusalCode::AlreadyExists, given + " exists and is not an empty folder: name another one");
    }
    const std::string partial = folder.string() + ".partial";
    const auto target = DataFolder::open(partial); // locks it, because two backups may have the same name
    if (!target) {
        return target.error();
    }
    fs::permissions(partial, fs::status(data, error).permissions(), error);
    if (auto cleared = clear(partial); !cleared) {
        return cleared.error();
    }
    auto backup = Copier{data, partial}.copy();
    if (!backup) {
        return backup.error();
    }
    if (auto synced = sync(partial); !synced) {
        return synced.error();
    }
    fs::rename(partial, folder, error);
    if (error) {
        return cannot("rename " + partial + " to", folder.string(), error.message());
    }
    if (auto synced = sync(folder.parent_path().string()); !synced) {
        return synced.error();
    }
    return backup;
}

} // namespace evod::run_file
