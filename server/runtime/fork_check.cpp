#include "server/runtime/fork_check.h"

#include "server/base/inline_executor.h"
#include "server/log/log.h"
#include "server/replay/recovery.h"

#include <chrono>
#include <thread>
#include <utility>

namespace evod::runtime {
namespace {

base::Result<void> check_once(const std::vector<std::string>& paths, const simulation::RunId& run_id,
                              const base::StateHash& hash) {
    for (const std::string& path : paths) {
        const auto file = run_file::RunFile::open_read_only(path);
        if (!file && file.error().code != base::RefusalCode::NotFound) {
            return file.error();
        }
        if (file && (*file)->identity().run_id == run_id) {
            base::InlineExecutor executor;
            return replay::check_beginning(**file, hash, executor);
        }
    }
    return {}; // another command has ended the run
}

/// If another command ends the run at the same time, the file and its log are renamed one after the other, and what is
/// between cannot be read.
base::Result<void> check_file(const std::vector<std::string>& paths, const simulation::RunId& run_id,
                              const base::StateHash& hash) {
    constexpr int attempts = 5;
    auto checked = check_once(paths, run_id, hash);
    for (int attempt = 1; !checked && attempt < attempts; ++attempt) {
        std::this_thread::sleep_for(std::chrono::milliseconds{100});
        checked = check_once(paths, run_id, hash);
    }
    return checked;
}

base::Refusal unreadable_fork(const std::string& why) {
    return base::refusal(base::RefusalCode::DataLoss, "the fork was created, but its run file cannot be read back: " +
                                                          why + "; delete the fork, and report this error");
}

} // namespace

recording::Done ForkCheck::read_back(std::vector<std::string> paths, const simulation::RunId& run_id,
                                     const base::StateHash& hash, std::shared_ptr<CommandDone> done,
                                     std::function<void(Reply)> reply) {
    return [jobs = jobs_, paths = std::move(paths), run_id, hash, waiting = std::move(done), reply = std::move(reply)] {
        jobs->add([=](const std::stop_token&) {
            const auto checked = check_file(paths, run_id, hash);
            if (!checked) {
                log::error({.world = waiting->outcome->world}, "{}", checked.error().message);
            }
            reply(checked ? std::move(*waiting)
                          : refused(std::move(*waiting), unreadable_fork(checked.error().message)));
        });
    };
}

} // namespace evod::runtime
