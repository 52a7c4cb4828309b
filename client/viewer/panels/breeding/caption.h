// Captions: what is seen at a moment of a breeding, in one or two sentences.
//
// Threads      none.
#pragma once

#include "client/viewer/panels/breeding/breeding_record.h"

#include <string>

namespace evod::viewer {

/// "Roulette with windowing · hybrid · 50 organisms, 25 picks → 25 survivors, 25 children"; empty before it is known.
std::string breeding_summary(const BreedingRecord& record);

/// "Pick 7 of 25. The pointer stopped at 0.4312 turns, in the slot of organism 17: …"
std::string caption(const BreedingRecord& record, Moment moment);

/// A parameter's choice as it is written: "stochastic universal".
std::string shown_choice(std::string choice);

} // namespace evod::viewer
