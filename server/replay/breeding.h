// Breeding: recomputes how one generation bred the next, from the records of both generations in the run file.
//
// Determinism  breeding_of() compares the recomputed descendants with the stored ones.
#pragma once

#include "server/base/executor.h"
#include "server/base/stop_check.h"
#include "server/evolution/breeding_record.h"
#include "server/run_file/run_file.h"

#include <optional>

namespace evod::replay {

struct WantedBreeding {
    std::optional<std::uint64_t> generation; // of the parents; nullopt: the last generation before `seen_from`
    std::uint64_t seen_from = 0;             // the generation that a viewer shows now
    std::uint32_t island = 0;
    evolution::WantedRows rows;
};

struct Bred {
    std::uint64_t generation = 0; // generation of the parents
    std::uint32_t island = 0;
    parameters::Parameters parameters; // the parameters in effect for this breeding
    evolution::BreedingRecord record;
};

/// file  must have a pinned snapshot.
/// stop  stops the work; the result is then a refusal with UNAVAILABLE.
///
/// Refused for the same reasons as GenerationReader::read(). Also refused if the generation or the island does not
/// exist, if no generation has bred yet, if the run follows another model, or if it cannot show a colony. Refused with
/// DATA_LOSS if the stored descendants differ.
base::Result<Bred> breeding_of(run_file::RunFile& file, const WantedBreeding& wanted, base::Executor& executor,
                               const base::StopCheck& stop);

} // namespace evod::replay
