// Captions: one or two sentences that explain what the glass box shows at a moment.
//
// Owner        BreedingPanel.
// Threads      none.
#pragma once

#include "client/viewer/panels/breeding/breeding_record.h"

#include <string>

namespace evod::viewer {

/// "Roulette with windowing · hybrid · 50 organisms, 25 picks → 25 survivors, 25 children"; empty at first.
std::string breeding_summary(const BreedingRecord& record);

/// "Pick 7 of 25. The pointer stopped at 0.4312 turns, in the slot of organism 17: …"
std::string caption(const BreedingRecord& record, Moment moment);

/// A parameter's choice as text: "stochastic universal".
std::string shown_choice(std::string choice);

} // namespace evod::viewer
