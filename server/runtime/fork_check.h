// Fork check: reads the file of a new fork back, as a restart would, before the client gets its answer.
//
// Owner        the simulation loop. A job owns its data, so jobs may outlive this object.
// Threads      read_back() is called on the simulation thread. It returns a function for the storage thread, which calls
//              it when the file is on the disk. The file is read by a background job.
#pragma once

#include "server/base/state_hash.h"
#include "server/jobs/job_queue.h"
#include "server/recording/storage_thread.h"
#include "server/runtime/replies.h"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace evod::runtime {

class ForkCheck {
  public:
    /// Returns a function that reads the file and then passes on the answer; if the file does not restore the world, it
    /// passes on a refusal.
    ///
    /// paths   where the file is, also after the run has ended.
    /// hash    state hash of the fork at its beginning.
    /// reply   any thread may call it.
    recording::Done read_back(std::vector<std::string> paths, const simulation::RunId& run_id,
                              const base::StateHash& hash, std::shared_ptr<CommandDone> done,
                              std::function<void(Reply)> reply);

  private:
    std::shared_ptr<jobs::JobQueue> jobs_ = std::make_shared<jobs::JobQueue>(jobs::JobQueue::Options{"fork check"});
};

} // namespace evod::runtime
