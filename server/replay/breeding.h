// Breeding: how a generation of a run bred the next, worked out again from what its file tells of both.
//
// Determinism  the descendants are compared with those that are stored.
#pragma once

#include "server/base/executor.h"
#include "server/evolution/breeding_record.h"
#include "server/run_file/run_file.h"

#include <optional>
#include <stop_token>

namespace evod::replay {

struct WantedBreeding {
    std::optional<std::uint64_t> generation; // of the parents; nothing: the last that was bred from
    std::uint64_t seen_from = 0;             // the generation from which that is looked for
    std::uint32_t island = 0;
    evolution::WantedRows rows;
};

struct Bred {
    std::uint64_t generation = 0; // of the parents
    std::uint32_t island = 0;
    parameters::Parameters parameters; // as they held
    evolution::BreedingRecord record;
};

/// file  held still. stop: when asked for, it is given up: refused with UNAVAILABLE.
///
/// Refused where GenerationReader is, where there are no such generation and island, or none has been bred from yet,
/// where the run follows another model, and with DATA_LOSS where the file tells of other descendants.
base::Result<Bred> breeding_of(run_file::RunFile& file, const WantedBreeding& wanted, base::Executor& executor,
                               const std::stop_token& stop);

} // namespace evod::replay
