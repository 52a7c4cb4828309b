// Written replies: does in a test what the dispatcher does with the replies to commands before it answers: it waits for
// the receipts, and reads the files of forks back.
//
// Threads      the simulation thread and the storage thread of the test may call it.
#pragma once

#include "server/runtime/fork_check.h"
#include "server/runtime/unwritten_replies.h"

#include <mutex>
#include <optional>
#include <utility>

namespace evod::support {

class WrittenReplies {
  public:
    /// Returns the reply that can be answered now.
    std::optional<runtime::Answer> pass(runtime::Reply reply) {
        std::unique_lock lock{mutex_};
        std::optional<runtime::Answer> answer = unwritten_.pass(std::move(reply));
        lock.unlock();
        if (answer) {
            if (auto* done = std::get_if<runtime::CommandDone>(&*answer); done && done->fork) {
                answer = check_fork(std::move(*done));
            }
        }
        return answer;
    }

  private:
    std::mutex mutex_; // guards the next member
    runtime::UnwrittenReplies unwritten_;
};

} // namespace evod::support
