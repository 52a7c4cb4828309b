// Receipt: what the storage thread reports about a record that carries a ticket.
#pragma once

#include "server/base/result.h"

#include <cstdint>
#include <functional>
#include <optional>

namespace evod::recording {

/// Identifies a record whose receipt is awaited; 0: no receipt is awaited. The simulation thread allocates tickets.
using Ticket = std::uint64_t;

struct Receipt {
    Ticket ticket = 0;
    std::optional<base::Refusal> refused = {}; // nullopt: the record is on the disk
};

/// A function that receives all receipts. The storage thread calls it, so it must not block.
using ReceiptSink = std::function<void(Receipt)>;

} // namespace evod::recording
