#include "server/runtime/fork.h"

#include "server/base/inline_executor.h"
#include "server/log/log.h"
#include "server/replay/recovery.h"

#include <chrono>
#include <thread>
#include <utility>

namespace evod::runtime {
namespace {

base::Result<void> check_once(const ForkFile& fork) {
    for (const std::string& path : fork.paths) {
        const auto file = run_file::RunFile::open_read_only(path);
        if (!file && file.error().code != base::RefusalCode::NotFound) {
            return file.error();
        }
        if (file && (*file)->identity().run_id == fork.run_id) {
            base::InlineExecutor executor;
            return replay::check_beginning(**file, fork.hash, executor);
        }
    }
    return {}; // another command has ended the run
}

/// If another command ends the run at the same time, the file and its log are renamed one after the other, and what is
/// between cannot be read.
base::Result<void> check_file(const ForkFile& fork, JobTurns::Turn& turn) {
    constexpr int attempts = 5;
    auto checked = check_once(fork);
    for (int attempt = 1; !checked && attempt < attempts; ++attempt) {
        turn.give_back();
        std::this_thread::sleep_for(std::chrono::milliseconds{100});
        turn.take();
        checked = check_once(fork);
    }
    return checked;
}

base::Refusal unreadable_fork(const std::string& why) {
    return base::refusal(base::RefusalCode::DataLoss, "the fork was created, but its run file cannot be read back: " +
                                                          why + "; delete the fork, and report this error");
}

} // namespace

bool begins_in_another_generation(const simulation::ForkWorld& command, const simulation::World& original) {
    return command.at_generation && *command.at_generation != original.moment().generation;
}

simulation::World world_of_fork(const simulation::ForkWorld& command, simulation::World world,
                                base::Executor& executor) {
    if (command.at_generation) {
        world = world.at_its_opening(executor);
    }
    world.become_fork();
    return world;
}

CommandDone check_fork(CommandDone done, JobTurns::Turn& turn) {
    const ForkFile file = *std::exchange(done.fork, std::nullopt);
    const auto checked = check_file(file, turn);
    if (!checked) {
        log::error({.world = done.outcome->world}, "{}", checked.error().message);
        return refused(std::move(done), unreadable_fork(checked.error().message));
    }
    return done;
}

} // namespace evod::runtime
