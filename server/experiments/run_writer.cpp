#include "server/experiments/run_writer.h"

#include "server/experiments/atomic_file.h"

#include <filesystem>
#include <utility>

namespace evod::experiments {

// Relaxed durability is sufficient, because finish() syncs the file before it renames it.
RunWriter::RunWriter(std::string path, std::string name, const simulation::RunId& run_id,
                     const simulation::World& world)
    : path_{std::move(path)}
    , temporary_path_{AtomicFile::temporary_name(path_)}
    , file_{run_file::RunFile::begin_new(temporary_path_, run_file::identity_of(world, std::move(name), run_id),
                                         {.durability = run_file::Durability::Relaxed})} {}

RunWriter::~RunWriter() {
    if (!file_ || *file_ == nullptr) {
        return;
    }
    file_->reset();
    (void)run_file::remove_run_file(temporary_path_); // if this fails, no program reads a file with that name
}

base::Result<void> RunWriter::follow(const simulation::World& world) {
    if (!file_) {
        return file_.error();
    }
    run_file::RunFile& file = **file_;
    new_records_.report(world, [&file](const auto& record) { file.write(record); });
    if (!world.generation_over()) {
        return {};
    }
    if (auto committed = file.commit(); !committed) {
        return committed;
    }
    if (auto thinned = file.shrink_if_large(); !thinned) {
        return thinned;
    }
    file.begin();
    return {};
}

base::Result<void> RunWriter::finish() {
    if (!file_) {
        return file_.error();
    }
    run_file::RunFile& file = **file_;
    file.write(run_file::EndMark{.tick = new_records_.tick()});
    if (auto committed = file.commit(); !committed) {
        return committed;
    }
    if (auto settled = file.merge_log(); !settled) {
        return settled;
    }
    file_->reset();
    if (auto synced = AtomicFile::sync(temporary_path_); !synced) {
        return synced;
    }
    if (auto renamed = run_file::rename_run_file(temporary_path_, path_); !renamed) {
        return renamed;
    }
    return AtomicFile::sync(std::filesystem::path{path_}.parent_path().string());
}

} // namespace evod::experiments
