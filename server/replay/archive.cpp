#include "server/replay/archive.h"

#include "server/base/within_memory.h"
#include "server/log/log.h"
#include "server/run_file/write_ahead_log.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <iterator>
#include <tuple>
#include <utility>

namespace evod::replay {

using base::Refusal;
using base::RefusalCode;
using base::Result;

Archive::Archive(run_file::DataFolder folder, const run_file::RunFile::Options& options)
    : folder_{std::move(folder)}
    , durability_{options.durability}
    , thread_{std::make_unique<recording::StorageThread>(options)}
    , recorder_{std::make_unique<recording::Recorder>(folder_, *thread_)} {}

namespace {

/// Whether a file has the end mark of a run that has ended.
Result<bool> is_over(run_file::RunFile& file) {
    const auto mark = file.end_mark();
    if (!mark) {
        return mark.error();
    }
    return *mark && (*mark)->ended;
}

/// Completes or undoes the creation or reset of a world that was interrupted by a crash. If the old run has its end
/// mark, the new run next to it is complete and replaces it. Otherwise the new run is deleted.
Result<void> finish_replacing(const run_file::DataFolder& folder, const std::string& path) {
    const std::string next = run_file::DataFolder::next_file_of(path);
    std::error_code error;
    if (std::filesystem::exists(path, error)) {
        auto old = run_file::RunFile::open_checked(path); // the end mark of the old run may be in the log
        if (!old) {
            return old.error();
        }
        const auto over = is_over(**old);
        if (!over) {
            return over.error();
        }
        if (!*over) {
            return run_file::remove_run_file(next);
        }
        const run_file::RunIdentity identity = (*old)->identity();
        old->reset();
        if (auto moved = run_file::rename_run_file(path, folder.ended_file_of(identity.name, identity.run_id));
            !moved) {
            return moved;
        }
    } else {
        const auto unmade = run_file::is_empty_file(next);
        if (!unmade) {
            return unmade.error();
        }
        if (*unmade) {
            return run_file::remove_run_file(next);
        }
    }
    return run_file::rename_run_file(next, path);
}

} // namespace

Result<std::unique_ptr<Archive>> Archive::open(const std::string& path, const run_file::RunFile::Options& options,
                                               base::Executor& executor) {
    auto folder = run_file::DataFolder::open(path);
    if (!folder) {
        return folder.error();
    }
    std::unique_ptr<Archive> archive{new Archive{*std::move(folder), options}};
    auto files = archive->folder_.files();
    for (const std::string& file : files ? files->replaced : std::vector<std::string>{}) {
        if (auto finished = finish_replacing(archive->folder_, file); !finished) {
            archive->add_damaged(file, finished.error());
        }
    }
    if (files && !files->replaced.empty()) {
        files = archive->folder_.files();
    }
    if (!files) {
        return files.error();
    }
    for (const std::string& file : files->strange) {
        log::warn("{} is ignored: the name of a run file is NAME.evod, where NAME is a valid world name", file);
    }

    std::vector<std::string> ended = files->ended, damaged;
    for (const std::string& file : files->of_worlds) {
        if (archive->is_damaged(run_file::world_of(file))) {
            continue;
        }
        const auto recovered = base::within_memory([&] { return archive->recover_world(file, options, executor); });
        if (!recovered && recovered.error().code == RefusalCode::ResourceExhausted) {
            archive->add_damaged(
                file, refusal(RefusalCode::Unavailable, file + ": there is not enough memory to restore its world"));
        } else if (!recovered) {
            archive->add_damaged(file, recovered.error());
        } else if (!recovered->empty()) {
            ended.push_back(*recovered);
        }
    }
    for (const std::string& file : files->of_worlds) {
        if (archive->is_damaged(run_file::world_of(file))) {
            damaged.push_back(file);
        }
    }
    archive->read_ended_answers(ended, damaged);
    return archive;
}

void Archive::read_ended_answers(const std::vector<std::string>& ended, const std::vector<std::string>& damaged) {
    struct EndedRun {
        std::filesystem::file_time_type when;
        std::string path;
        bool has_ended; // otherwise the world is damaged, and only the keys are read
        std::vector<run_file::UsedKey> keys = {};
        std::vector<run_file::JournalEntry> last = {};
    };
    std::vector<EndedRun> runs;
    for (const auto* paths : {&ended, &damaged}) {
        for (const std::string& path : *paths) {
            std::error_code error;
            runs.push_back({std::filesystem::last_write_time(path, error), path, paths == &ended});
        }
    }
    std::ranges::sort(runs, std::greater{}, [](const EndedRun& run) { return std::tie(run.when, run.path); });
    std::size_t bytes = 0;
    for (EndedRun& run : runs) {
        // Reading a damaged log would replace the index that shows the damage.
        const auto file =
            run.has_ended ? run_file::RunFile::open_read_only(run.path) : run_file::RunFile::open_checked(run.path);
        if (!file && !run.has_ended) {
            continue; // the reason is already logged
        }
        if (!file) { // no world depends on this file
            log::warn(
                "{} cannot be read, so commands that it contains may be applied again if a client repeats them: {}",
                run.path, file.error().message);
            continue;
        }
        const std::uint64_t last = (*file)->journal().last_number();
        std::uint64_t count = 0;
        if (run.has_ended) {
            // The last answer in a file is the answer to the command that ended the run.
            count = std::min<std::uint64_t>(last, bytes < answers_of_ended_bytes_max ? answers_kept_of_ended : 1);
            if (auto entries = (*file)->journal().read(last + 1 - count)) {
                run.last = *std::move(entries);
            } else {
                count = 0;
            }
        }
        if (auto keys = (*file)->journal().used_keys(last - count, keys_kept_of_ended)) {
            run.keys = *std::move(keys);
        } else {
            log::warn("{} is damaged, so commands that it contains may be applied again if a client repeats them: {}",
                      run.path, keys.error().message);
        }
        for (const run_file::JournalEntry& entry : run.last) {
            bytes += entry.origin.request.size() + entry.answer.size();
        }
    }
    std::vector<run_file::JournalEntry> answers;
    for (auto run = runs.rbegin(); run != runs.rend(); ++run) {
        std::ranges::move(run->keys, std::back_inserter(used_keys_));
        std::ranges::move(run->last, std::back_inserter(answers));
    }
    std::ranges::move(answers_, std::back_inserter(answers));
    answers_ = std::move(answers);
}

Result<std::string> Archive::recover_world(const std::string& path, const run_file::RunFile::Options& options,
                                           base::Executor& executor) {
    // With relaxed durability, after a crash of the machine the index on the disk may be newer than the log.
    const auto index =
        options.durability == run_file::Durability::Full ? run_file::LogIndex::Read : run_file::LogIndex::Unread;
    if (auto sound = run_file::check_log(path, index); !sound) {
        return sound.error();
    }
    if (auto single = run_file::expect_file_with_one_name(path); !single) {
        return single.error();
    }
    // SQLite would copy the log into the file when a connection that may write is closed.
    auto stored = run_file::RunFile::open_read_only(path);
    if (!stored) {
        return stored.error();
    }
    const run_file::RunIdentity identity = (*stored)->identity();
    const auto over = is_over(**stored);
    if (!over) {
        return over.error();
    }
    if (*over) {
        // The server was stopped before it could rename the file.
        stored->reset();
        const std::string ended = folder_.ended_file_of(identity.name, identity.run_id);
        if (auto renamed = run_file::rename_run_file(path, ended); !renamed) {
            return renamed.error();
        }
        return ended;
    }
    const bool was_closed = (*stored)->end_mark()->has_value();
    auto recovered = recover(**stored, executor);
    if (!recovered) {
        return recovered.error();
    }
    stored->reset();
    auto file = run_file::RunFile::open(path, options);
    if (!file) {
        return file.error();
    }
    const run_file::EndMark contents = (*file)->contents();
    const std::uint64_t generations_ended = (*file)->generations().last_ended();
    const std::string name = run_file::world_of(path);
    log::info({.world = name}, "world \"{}\" continues from generation {}, tick {} of {}{}", name,
              recovered->world.moment().generation, recovered->world.moment().tick, path,
              was_closed ? "" : "; the previous server did not close this file");
    auto entry = std::make_unique<simulation::Entry>(
        simulation::Entry{name, identity.run_id, recovered->control, std::move(recovered->world)});
    entry->ownership = identity.ownership;
    recording::RunRecorder& run = recorder_->resume(name, *std::move(file), contents, generations_ended);
    run.follow(entry->world);
    laboratory_.adopt(std::move(entry));
    identities_.push_back(identity);
    identities_.back().name = name;
    answers_.insert(answers_.end(), std::make_move_iterator(recovered->journal.begin()),
                    std::make_move_iterator(recovered->journal.end()));
    return std::string{};
}

void Archive::add_damaged(const std::string& path, const Refusal& why) {
    simulation::DamagedWorld world = damaged_world(run_file::world_of(path), {}, why);
    if (const auto file = run_file::RunFile::open_checked(path)) {
        world.run_id = (*file)->identity().run_id;
    }
    log::error({.world = world.name}, "world \"{}\" does not run: {}", world.name, world.reason);
    damaged_.push_back(world.name);
    laboratory_.adopt(std::move(world));
}

bool Archive::is_damaged(const std::string& world) const {
    return std::ranges::find(damaged_, world) != damaged_.end();
}

std::vector<std::string> Archive::world_names() const {
    std::vector<std::string> names = damaged_;
    for (const run_file::RunIdentity& identity : identities_) {
        names.push_back(identity.name);
    }
    std::ranges::sort(names);
    return names;
}

const run_file::RunIdentity* Archive::identity_of(const std::string& world) const {
    const auto found = std::ranges::find(identities_, world, &run_file::RunIdentity::name);
    return found == identities_.end() ? nullptr : &*found;
}

} // namespace evod::replay
