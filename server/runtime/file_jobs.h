// File jobs: background jobs that read run files for the loop of the replays.
//
// Users        one job of each user runs at a time, in the order in which they were added. So one user's many jobs do
//              not delay those of another user. All jobs share the processors with the other background jobs
//              (job_turns.h).
// Owner        the loop of the replays, on its thread. A job returns its result through the mailbox.
// Full         never: the loop bounds the number of seeks and replays.
#pragma once

#include "server/jobs/job_queue.h"
#include "server/runtime/job_turns.h"

#include <functional>
#include <string>
#include <utility>

namespace evod::runtime {

class FileJobs {
  public:
    static constexpr std::size_t users_at_once = 8;

    /// turns  must outlive this object.
    explicit FileJobs(JobTurns& turns) : turns_{turns} {}

    /// stop  whether the job is cancelled. The job must ask it often.
    using Job = std::function<void(const base::StopCheck& stop)>;
    /// Adds a job.
    ///
    /// user     whose account pays for its time.
    /// returns  a handle that cancels the job. A job that is cancelled before it begins does not run.
    std::stop_source add(const std::string& user, Job job) {
        return queue_.add(
            [&turns = turns_, user, job = std::move(job)](const std::stop_token& stop) {
                JobTurns::Turn turn{turns, user, stop};
                if (turn.go_on()) {
                    job(turn.stop_check());
                }
            },
            user);
    }

  private:
    JobTurns& turns_;
    jobs::JobQueue queue_{{.name = "replay files",
                           .threads_max = users_at_once,
                           .threads_per_user_max = 1,
                           .niceness = JobTurns::niceness}};
};

} // namespace evod::runtime
