#include "server/replay/run_file_fork.h"

#include "server/replay/recovery.h"
#include "server/replay/rerun.h"
#include "server/run_file/data_folder.h"

#include <utility>
#include <vector>

namespace evod::replay {

namespace {

base::Result<simulation::World> world_at(run_file::RunFile& origin, std::optional<std::uint64_t> generation,
                                         base::Executor& executor) {
    if (!generation) {
        auto last = recover(origin, executor);
        if (!last) {
            return last.error();
        }
        return std::move(last->world);
    }
    if (*generation < origin.identity().first_generation || *generation > origin.generations().last()) {
        return base::Refusal{.code = base::RefusalCode::NotFound,
                             .message = origin.path() + " has no such generation",
                             .violations = {{"generation",
                                             std::to_string(origin.identity().first_generation) + " to " +
                                                 std::to_string(origin.generations().last()),
                                             std::to_string(*generation)}},
                             .reason = base::Reason::MomentNotFound};
    }
    auto there = Rerun::at(origin, *generation, executor);
    if (!there) {
        return there.error();
    }
    return std::move(*there).take().at_its_opening(executor);
}

} // namespace

base::Result<simulation::Moment> fork(run_file::RunFile& origin, std::optional<std::uint64_t> generation,
                                      const std::string& path, const std::string& name, const simulation::RunId& run_id,
                                      base::Executor& executor) {
    auto world = world_at(origin, generation, executor);
    if (!world) {
        return world.error();
    }
    world->become_fork();
    run_file::RunBeginning beginning =
        run_file::beginning_of_fork(*world, name, run_id, origin.identity().run_id, executor);
    const run_file::RunIdentity identity = beginning.identity;
    auto file = run_file::RunFile::create(path, identity, {.keep_every = origin.retention().keep_every()},
                                          run_file::RunFile::records_of(std::move(beginning)));
    if (!file) {
        return file.error();
    }
    (*file)->begin();
    (*file)->write(run_file::EndMark{.tick = world->moment().tick});
    if (auto closed = (*file)->commit(); !closed) {
        return closed.error();
    }
    if (auto whole = check_beginning(**file, world->hash(), executor); !whole) {
        file->reset();
        (void)run_file::remove_run_file(path);
        return whole.error();
    }
    return world->moment();
}

} // namespace evod::replay
