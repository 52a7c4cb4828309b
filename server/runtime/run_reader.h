// Run reader: waits until the records of a run are on the disk, and reads run files on a job queue.
//
// Owner        Replays, on the simulation thread.
// Threads      the jobs of the queue return their results through the mailbox.
#pragma once

#include "server/jobs/job_queue.h"
#include "server/recording/recorder.h"
#include "server/runtime/mailbox.h"

#include <functional>
#include <map>
#include <string>

namespace evod::runtime {

class RunReader {
  public:
    /// All arguments must outlive this object. recorder: nullptr if the server stores no runs.
    RunReader(Mailbox& mailbox, recording::Recorder* recorder) : mailbox_{mailbox}, recorder_{recorder} {}

    /// Calls `then` on the simulation thread once all records of the world are on the disk. Calls it with false
    /// if nothing can be written to the file of the world, or if the world has no file.
    void once_written(const std::string& world, std::function<void(bool all_is_written)> then);
    /// Calls every waiting `then` with false. Must be called when nothing can be written to the disk.
    void stop_waiting();
    /// Calls every `then` that waits for this world with false.
    void stop_waiting(const std::string& world);
    /// Runs `read` on the job queue, then runs the function that `read` returned on the simulation thread.
    void read(std::function<std::function<void()>()> read);

  private:
    Mailbox& mailbox_;
    recording::Recorder* recorder_;
    struct Waiting {
        std::string world;
        std::function<void(bool all_is_written)> then;
    };
    std::map<std::uint64_t, Waiting> waiting_;
    std::uint64_t last_waiting_ = 0;
    jobs::JobQueue jobs_{{.name = "replay"}}; // last member, because its jobs use the others
};

} // namespace evod::runtime
