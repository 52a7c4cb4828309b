// Run finder: finds the stored runs of live worlds, for exports, breedings, replays and forks.
//
// Owner        a simulation loop, on its thread.
#pragma once

#include "server/recording/recorder.h"
#include "server/runtime/loop_outputs.h"
#include "server/simulation/laboratory.h"

namespace evod::runtime {

class RunFinder {
  public:
    /// All arguments must outlive this object. recorder: nullptr if runs are not stored.
    RunFinder(const simulation::Laboratory& laboratory, recording::Recorder* recorder, const LoopOutputs& outputs)
        : laboratory_{laboratory}, recorder_{recorder}, outputs_{outputs} {}

    /// Returns the stored run of a live world; refused if there is none.
    base::Result<FoundRun> run_of(const simulation::Entry& world) const;
    /// Answers the request, once everything recorded so far is on the disk or cannot be written.
    void find(const FindRun& mail);

  private:
    const simulation::Laboratory& laboratory_;
    recording::Recorder* const recorder_;
    const LoopOutputs& outputs_;
};

} // namespace evod::runtime
