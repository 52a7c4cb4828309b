#include "server/runtime/run_finder.h"

#include "evod/v1/commands.pb.h"

#include <utility>

namespace evod::runtime {

base::Result<FoundRun> RunFinder::run_of(const simulation::Entry& world) const {
    if (!recorder_) {
        return refusal(base::RefusalCode::FailedPrecondition,
                       "this server stores no runs, so it cannot replay them: start it without --keep-nothing",
                       base::Reason::RunsNotKept);
    }
    const simulation::Moment& now = world.world.moment();
    return FoundRun{.world = world.name,
                    .run = {recorder_->paths_of(world.name, world.run_id), world.run_id},
                    .ownership = world.ownership,
                    .generation = now.generation,
                    .until = {.generation = now.generation, .tick = now.tick}};
}

void RunFinder::find(const FindRun& mail) {
    const auto entry = laboratory_.find(mail.world);
    if (!entry) {
        const simulation::DamagedWorld* damaged = laboratory_.find_damaged(mail.world);
        const auto* request = std::get_if<std::shared_ptr<const v1::Request>>(&mail.purpose);
        if (damaged && damaged->run_id && request && (*request)->has_export_run()) {
            const replay::StoredRun run{recorder_->paths_of(damaged->name, *damaged->run_id), *damaged->run_id};
            return outputs_.reply(RunFound{mail, FoundRun{damaged->name, run}});
        }
        return outputs_.reply(RunFound{mail, entry.error()});
    }
    auto run = run_of(**entry);
    if (!run) {
        return outputs_.reply(RunFound{mail, run.error()});
    }
    recording::RunRecorder* const recorder = recorder_->of((*entry)->name);
    if (recorder == nullptr || recorder_->refusal()) {
        run->until = {}; // nothing more will be written
        return outputs_.reply(RunFound{mail, *std::move(run)});
    }
    const recording::Ticket ticket = recorder_->next_ticket();
    outputs_.reply(RunFound{mail, *std::move(run), ticket});
    recorder->once_written(ticket);
}

} // namespace evod::runtime
