#include "server/replay/recovery.h"

#include "server/replay/rerun.h"
#include "server/run_file/check.h"

#include <utility>

namespace evod::replay {

using base::RefusalCode;
using base::Result;

namespace {

base::Refusal not_recovered(const run_file::RunFile& file, const std::string& why) {
    return {.code = RefusalCode::DataLoss, .message = file.path() + " is damaged: " + why, .violations = {}};
}

} // namespace

Result<Recovered> recover(run_file::RunFile& file, base::Executor& executor) {
    if (auto whole = check_end_mark(file); !whole) {
        return whole.error();
    }
    if (auto refused = file.other_model()) {
        return *refused;
    }
    auto journal = file.journal().read();
    if (!journal) {
        return journal.error();
    }
    auto changes = world_changes(file.path(), *journal);
    if (!changes) {
        return changes.error();
    }
    const std::uint64_t last_tick = file.last_tick();
    auto rerun = Rerun::before(file, file.generations().at_tick(last_tick), last_tick, *changes,
                               simulation::history_generations_kept, executor);
    if (!rerun) {
        return rerun.error();
    }
    *changes = {}; // the rerun drops each change when it has applied it
    const std::uint64_t from = rerun->world().moment().tick;
    const auto hashes = file.hashes(from, last_tick);
    if (!hashes) {
        return hashes.error();
    }
    for (const run_file::HashRecord& hash : *hashes) {
        rerun->advance_to(hash.tick, executor);
        if (rerun->world().moment().tick != hash.tick || rerun->hash_of_tick() != hash.hash) {
            return not_recovered(file, "the stored state hash of tick " + std::to_string(hash.tick) +
                                           " differs from that of a new simulation");
        }
    }
    rerun->advance_to(last_tick, executor);
    if (const auto& fault = rerun->changes().fault()) {
        return *fault;
    }
    if (rerun->world().moment().tick != last_tick) {
        return not_recovered(file, "it contains tick " + std::to_string(last_tick) + ", but the run ends at tick " +
                                       std::to_string(rerun->world().moment().tick));
    }
    Recovered recovered{std::move(*rerun).take(), {}, *std::move(journal)};
    if (!recovered.journal.empty()) {
        recovered.control = recovered.journal.back().control;
    }
    simulation::remove_reached_goals(recovered.control, recovered.world);
    return recovered;
}

Result<void> check_beginning(run_file::RunFile& file, const base::StateHash& hash, base::Executor& executor) {
    const auto begun = Rerun::begun_at(file, file.identity().first_generation, nullptr, {},
                                       simulation::history_generations_kept, executor);
    if (!begun) {
        return begun.error();
    }
    if (begun->world().hash() != hash) {
        return not_recovered(file, "the state with which its run begins has another state hash than its world");
    }
    return {};
}

base::Refusal with_remedies(base::Refusal why) {
    switch (why.code) {
    case RefusalCode::NotFound:
        return why; // it is not a fault of this file, so the remedies do not apply
    case RefusalCode::DataLoss:
        why.message += "; check the file with evod verify, save what can be read with evod export, and restore a copy";
        break;
    case RefusalCode::Unavailable:
        why.message += "; remove the cause, and start the server again";
        break;
    case RefusalCode::FailedPrecondition: // another version of the model or of the format
        why.message += "; start the version of evod that wrote the file, or save what can be read with evod export";
        break;
    default:
        break;
    }
    why.message += "; deleting the world moves the file away";
    return why;
}

simulation::DamagedWorld damaged_world(std::string name, const std::optional<simulation::RunId>& run_id,
                                       const base::Refusal& why) {
    return {.name = std::move(name), .run_id = run_id, .reason = with_remedies(why).message};
}

} // namespace evod::replay
