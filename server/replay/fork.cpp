#include "server/replay/fork.h"

#include "server/replay/recovery.h"
#include "server/replay/rerun.h"

#include <chrono>
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
    return std::move(*there).take();
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
    const simulation::Moment moment = world->moment();
    run_file::Inherited inherited = run_file::inherited_by(*world);
    const std::uint64_t inherited_generations = inherited.history.size();
    std::vector<run_file::RunFile::Record> first{run_file::beginning_of(*world)};
    // After the beginning of a generation, the fork needs a checkpoint: its file lacks the commands since then.
    if (!world->is_as_begun()) {
        first.emplace_back(run_file::checkpoint_of(*world, 0, executor));
    }
    first.emplace_back(std::move(inherited));
    using namespace std::chrono;
    const auto file = run_file::RunFile::create(
        path,
        {.name = name,
         .run_id = run_id,
         .seed = origin.identity().seed,
         .parameters = world->parameters().requested,
         .began_unix_ms = duration_cast<milliseconds>(system_clock::now().time_since_epoch()).count(),
         .first_generation = moment.generation,
         .first_tick = moment.tick,
         .forked_from = origin.identity().run_id,
         .inherited_generations = inherited_generations,
         .first_population = origin.identity().first_population,
         .schedule = origin.identity().schedule},
        {.keep_every = origin.retention().keep_every()}, first);
    if (!file) {
        return file.error();
    }
    (*file)->begin();
    (*file)->write(run_file::EndMark{.tick = moment.tick});
    if (auto closed = (*file)->commit(); !closed) {
        return closed.error();
    }
    return moment;
}

} // namespace evod::replay
