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
    /// Receipts from this ticket on return to the simulation thread, the others go to the network thread.
    static constexpr recording::Ticket first_ticket = recording::Ticket{1} << 63;

    /// All arguments must outlive this object. recorder: nullptr if the server stores no runs.
    RunReader(Mailbox& mailbox, recording::Recorder* recorder) : mailbox_{mailbox}, recorder_{recorder} {}

    /// Calls `then` on the simulation thread once all records of the world are on the disk. Calls it with false
    /// if nothing can be written to the file of the world, or if the world has no file.
    void once_written(const std::string& world, std::function<void(bool all_is_written)> then);
    /// Calls the function that waits for this receipt.
    void take(const recording::Receipt& receipt);
    /// Runs `read` on the job queue, then runs the function that `read` returned on the simulation thread.
    void read(std::function<std::function<void()>()> read);

  private:
    Mailbox& mailbox_;
    recording::Recorder* recorder_;
    std::map<recording::Ticket, std::function<void(bool all_is_written)>> waiting_;
    recording::Ticket next_ticket_ = first_ticket;
    jobs::JobQueue jobs_{{.name = "replay"}}; // last member, because its jobs use the others
};

} // namespace evod::runtime
