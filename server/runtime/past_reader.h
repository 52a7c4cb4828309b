// Past reader: reads what the files of runs tell of the past, so that the simulation does not wait for that.
//
// Threads  one of its own, from when it is first asked; asked, and answered by way of the mailbox, on the simulation
//          thread.
// Full     never: whoever asks bounds how many are under way.
#pragma once

#include "server/runtime/mailbox.h"

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <stop_token>
#include <thread>

namespace evod::runtime {

class PastReader {
  public:
    /// mailbox  outlives this.
    explicit PastReader(Mailbox& mailbox) : mailbox_{mailbox} {}

    /// What is done with what has been read: on the simulation thread, and not at all once this is gone.
    using Then = std::function<void()>;
    using Read = std::function<Then()>;
    /// Each after the one before.
    void ask(Read read);

  private:
    void work(const std::stop_token& stop);

    Mailbox& mailbox_;
    std::mutex mutex_; // guards what follows
    std::condition_variable_any changed_;
    std::deque<Read> waiting_;
    std::jthread thread_; // last: it uses the rest
};

} // namespace evod::runtime
