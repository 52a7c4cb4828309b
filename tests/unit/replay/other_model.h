// Other model: a run file of another model version, whose generations that are not retained are lost.
#pragma once

#include "server/base/inline_executor.h"
#include "server/run_file/run_file.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>

namespace evod::replay {
using namespace run_file;

/// Eight generations, of which 1, 4, 7 and the last are retained.
inline std::unique_ptr<RunFile> record_other_model(const std::string& path, const parameters::Parameters& parameters) {
    RunIdentity identity{.name = "w", .run_id = {1, 2}, .seed = {7}, .parameters = parameters};
    identity.model_version = simulation::model_version + 1;
    auto file = *RunFile::create(path, identity, {.keep_every = 3});
    base::InlineExecutor executor;
    simulation::World world{parameters, identity.seed};
    file->begin();
    file->write(beginning_of(world));
    for (int generation = 1; generation < 8; ++generation) {
        while (!world.generation_over()) {
            world.advance_tick(executor);
        }
        file->write(end_of(world));
        world.breed_next_generation(executor);
        file->write(beginning_of(world));
    }
    EXPECT_TRUE(file->commit());
    return file;
}

} // namespace evod::replay
