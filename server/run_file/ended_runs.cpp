#include "server/run_file/ended_runs.h"

#include "server/run_file/data_folder.h"

#include <algorithm>
#include <map>
#include <string_view>
#include <system_error>
#include <tuple>

namespace evod::run_file {

namespace fs = std::filesystem;
using base::Result;

namespace {

bool is_run_id(std::string_view text) {
    constexpr std::size_t digits = 32;
    return text.size() == digits && text.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

} // namespace

Result<std::vector<EndedRun>> surplus_runs(const std::string& folder, std::uint64_t keep, const std::string& world) {
    const auto files = DataFolder::files_in(folder);
    if (!files) {
        return files.error();
    }
    std::vector<EndedRun> runs;
    for (const std::string& path : files->ended) {
        const std::string stem = world_of(path);
        std::error_code error;
        if (!is_run_id(stem.substr(stem.find('.') + 1)) || !fs::is_regular_file(fs::symlink_status(path, error))) {
            continue; // a person has put it there
        }
        runs.push_back({stem.substr(0, stem.find('.')), path, bytes_of_run(path), fs::last_write_time(path, error)});
    }
    std::ranges::sort(runs, {}, [](const EndedRun& run) { return std::tie(run.ended, run.path); });
    std::map<std::string, std::uint64_t> surplus;
    for (const EndedRun& run : runs) {
        ++surplus[run.world];
    }
    for (auto& [name, count] : surplus) {
        count = world.empty() || name == world ? count - std::min(count, keep) : 0;
    }
    std::erase_if(runs, [&](const EndedRun& run) { // called once for each run, in their order
        std::uint64_t& left = surplus[run.world];
        return left == 0 || (--left, false);
    });
    return runs;
}

Result<Pruned> prune(const std::string& folder, std::uint64_t keep, const std::string& world) {
    const auto runs = surplus_runs(folder, keep, world);
    if (!runs) {
        return runs.error();
    }
    Pruned pruned;
    for (const EndedRun& run : *runs) {
        if (const auto removed = remove_run_file(run.path); removed) {
            pruned.deleted.push_back(run);
        } else {
            pruned.failures.push_back(removed.error().message);
        }
    }
    return pruned;
}

std::uint64_t bytes_of_run(const std::string& path) {
    std::uint64_t bytes = 0;
    for (const char* suffix : {"", "-wal", "-shm"}) {
        std::error_code error;
        if (const auto size = fs::file_size(path + suffix, error); !error) {
            bytes += size;
        }
    }
    return bytes;
}

std::uint64_t bytes_of_folder(const std::string& folder) {
    std::uint64_t bytes = 0;
    std::error_code error;
    for (fs::directory_iterator file{folder, error}, end; !error && file != end; file.increment(error)) {
        std::error_code gone; // a file may be deleted meanwhile
        if (file->is_regular_file(gone)) {
            const auto size = file->file_size(gone);
            bytes += gone ? 0 : size;
        }
    }
    return bytes;
}

} // namespace evod::run_file
