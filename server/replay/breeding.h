// Breeding: recomputes how a generation of a run bred the next one, from the records of both in its file.
//
// Determinism  the recomputed descendants are compared with the stored ones.
#pragma once

#include "server/base/executor.h"
#include "server/evolution/breeding_record.h"
#include "server/run_file/run_file.h"

#include <optional>
#include <stop_token>

namespace evod::replay {

struct WantedBreeding {
    std::optional<std::uint64_t> generation; // of the parents; nothing: the last one before `seen_from`
    std::uint64_t seen_from = 0;             // a viewer's present generation
    std::uint32_t island = 0;
    evolution::WantedRows rows;
};

struct Bred {
    std::uint64_t generation = 0; // of the parents
    std::uint32_t island = 0;
    parameters::Parameters parameters; // in effect when it bred
    evolution::BreedingRecord record;
};

/// file  with a pinned snapshot.
/// stop  cancels the work: refused with UNAVAILABLE.
///
/// Refused where GenerationReader is, if there is no such generation or island, if no generation has bred yet, if the run
/// follows another model, and with DATA_LOSS if the stored descendants differ.
base::Result<Bred> breeding_of(run_file::RunFile& file, const WantedBreeding& wanted, base::Executor& executor,
                               const std::stop_token& stop);

} // namespace evod::replay
