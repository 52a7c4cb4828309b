// Captions: one or two sentences that explain the moment that the glass box shows.
//
// Owner        BreedingPanel.
// Threads      none.
#pragma once

#include "client/viewer/panels/breeding/breeding_record.h"

#include <string>

namespace evod::viewer {

/// Returns a summary of the breeding: "Roulette with windowing · hybrid · 50 organisms, 25 picks → 25 survivors, 25
/// children"; empty until the first page has arrived.
std::string breeding_summary(const BreedingRecord& record);

/// Returns the caption of a moment: "Pick 7 of 25. The pointer stopped at 0.4312 turns, in the slot of organism 17: …".
std::string caption(const BreedingRecord& record, Moment moment);

/// Returns the law of the selection method in a sentence: "Roulette wheel: an organism with twice the weight is picked
/// twice as often on average."
std::string selection_law_text(const BreedingRecord& record);

/// Returns the value of a parameter with named choices, as text for users: "stochastic universal".
std::string shown_choice(std::string choice);

} // namespace evod::viewer
