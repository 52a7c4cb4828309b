#include "server/console/run_writer.h"

#include "server/console/new_file.h"

#include <chrono>
#include <filesystem>
#include <utility>

namespace evod::console {

namespace {

storage::RunIdentity identity_of(std::string name, const simulation::RunId& run_id, const simulation::World& world) {
    using namespace std::chrono;
    return {.name = std::move(name),
            .run_id = run_id,
            .seed = world.seed(),
            .parameters = world.parameters().requested,
            .began_unix_ms = duration_cast<milliseconds>(system_clock::now().time_since_epoch()).count(),
            .first_population = world.first_population(),
            .schedule = world.schedule()};
}

} // namespace

// What survives the program is enough until the file is whole: it is put on the disk before it gets its name.
RunWriter::RunWriter(std::string path, std::string name, const simulation::RunId& run_id,
                     const simulation::World& world)
    : path_{std::move(path)}
    , unfinished_{NewFile::unfinished_name(path_)}
    , file_{storage::RunFile::begin_new(unfinished_, identity_of(std::move(name), run_id, world),
                                        {.durability = storage::Durability::Relaxed})} {}

RunWriter::~RunWriter() {
    if (!file_ || *file_ == nullptr)
        return;
    file_->reset();
    (void)storage::RunFile::remove(unfinished_); // at worst it is left there, under a name that nobody reads
}

base::Result<void> RunWriter::follow(const simulation::World& world) {
    if (!file_)
        return file_.error();
    storage::RunFile& file = **file_;
    const simulation::Moment& moment = world.moment();
    if (moment.generation != generation_)
        file.write(storage::beginning_of(world));
    if (moment.tick > tick_ && moment.tick % storage::ticks_per_link == 0)
        file.write(storage::HashLink{moment.tick, world.hash()});
    generation_ = moment.generation;
    tick_ = moment.tick;
    if (!world.generation_over())
        return {};
    file.write(storage::end_of(world));
    if (auto committed = file.commit(); !committed)
        return committed;
    if (auto thinned = file.thin_if_large(); !thinned)
        return thinned;
    file.begin();
    return {};
}

base::Result<void> RunWriter::finish() {
    if (!file_)
        return file_.error();
    storage::RunFile& file = **file_;
    file.write(storage::EndMark{.tick = tick_});
    if (auto committed = file.commit(); !committed)
        return committed;
    if (auto settled = file.settle(); !settled)
        return settled;
    file_->reset();
    if (auto kept = NewFile::keep(unfinished_); !kept)
        return kept;
    if (auto named = storage::RunFile::rename(unfinished_, path_); !named)
        return named;
    return NewFile::keep(std::filesystem::path{path_}.parent_path().string());
}

} // namespace evod::console
