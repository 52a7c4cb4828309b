#include "server/storage/fork.h"

#include "server/storage/rerun.h"

#include <chrono>

namespace evod::storage {

base::Result<void> fork(RunFile& origin, std::uint64_t generation, const std::string& path, const std::string& name,
                        const simulation::RunId& run_id, base::Executor& executor) {
    if (generation < origin.identity().first_generation || generation > origin.last_generation())
        return base::Refusal{.code = base::RefusalCode::NotFound,
                             .message = origin.path() + " does not hold the beginning of that generation",
                             .violations = {{"generation",
                                             std::to_string(origin.identity().first_generation) + " to " +
                                                 std::to_string(origin.last_generation()),
                                             std::to_string(generation)}}};
    auto there = Rerun::at(origin, generation, executor);
    if (!there)
        return there.error();
    simulation::World world = std::move(*there).take();
    world.become_fork();
    const GenerationBegun begun = beginning_of(world);
    const Inherited inherited = inherited_by(world);
    using namespace std::chrono;
    const auto file =
        RunFile::create(path,
                        {.name = name,
                         .run_id = run_id,
                         .seed = origin.identity().seed,
                         .parameters = begun.opening.parameters.requested,
                         .began_unix_ms = duration_cast<milliseconds>(system_clock::now().time_since_epoch()).count(),
                         .first_generation = generation,
                         .first_tick = begun.opening.moment.tick,
                         .forked_from = origin.identity().run_id,
                         .inherited_generations = inherited.history.size(),
                         .first_population = origin.identity().first_population},
                        {.keep_every = origin.keep_every()}, &begun, nullptr, &inherited);
    if (!file)
        return file.error();
    (*file)->begin();
    (*file)->write(EndMark{.tick = begun.opening.moment.tick});
    return (*file)->commit();
}

} // namespace evod::storage
