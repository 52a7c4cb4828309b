// Unwritten replies: replies whose records are not on the disk yet. Each waits for the receipt with its ticket.
//
// Owner        the simulations, on the network thread.
// Order        a reply with a ticket comes before its receipt, so that every receipt finds its reply.
// Full         the limits of unanswered requests bound the number of replies.
#pragma once

#include "server/runtime/replies.h"

#include <map>
#include <optional>

namespace evod::runtime {

class UnwrittenReplies {
  public:
    /// Takes the next reply from the outbox. Returns what can be answered now: a reply without a ticket, or the reply
    /// that waited for this receipt. If a command will never be on the disk, its reply becomes a refusal. Messages
    /// between the simulation threads must not get here.
    std::optional<Answer> pass(Reply reply);

  private:
    std::map<recording::Ticket, Answer> waiting_;
};

} // namespace evod::runtime
