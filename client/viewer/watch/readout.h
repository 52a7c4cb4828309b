// Readout: what the strips at the top and at the bottom of the window say, as text.
//
// Threads      none.
#pragma once

#include "client/core/connection.h"
#include "client/viewer/text/numbers.h"
#include "client/viewer/watch/run_control.h"

#include <string>
#include <vector>

namespace evod::viewer {

std::string shown_speed(const evod::v1::Speed& speed); // "4×", "1/4×", "max"
/// storage  as it stands: a world that runs may have to wait for it.
const char* shown_state(evod::v1::RunState state, const evod::v1::Storage& storage);
/// The same without the key that runs it.
const char* state_word(evod::v1::RunState state, const evod::v1::Storage& storage);

/// What a person has to know of it: "Commands are refused: …", "Worlds wait for the disk: …"; empty while it keeps up.
std::string shown_storage(const evod::v1::Storage& storage);

/// Why the server says no, for a person: "There is no such island (9); allowed: 0 to 7".
std::string shown_refusal(const evod::v1::Status& status);

/// Why there is no connection, in a sentence for a person who sees fields for server and token; empty if nothing is
/// wrong.
std::string shown_loss(const core::ConnectionStatus& status, bool came_with_token);

/// "Generation 12"; empty before the first picture.
std::string title(const evod::v1::SnapshotFrame& picture);

/// Before the title of a world that shows what has been: "PAST of default", or "REPLAY" of a run file.
std::string past_mark(const evod::v1::Replay& replay);

/// "default · island 2 of 0–7"
std::string shown_place(const evod::v1::SnapshotFrame& picture);
/// "default · island 2 of 0–7 · 4× (240 ticks/s)"; the state is written beside it.
std::string place_and_speed(const evod::v1::SnapshotFrame& picture, const RunControl& control);

/// The statistics line in pieces, the more important first, so that a narrow window leaves out the others.
std::vector<std::string> statistics(const evod::v1::SnapshotFrame& picture,
                                    const evod::v1::GenerationStatistics* last_generation);

} // namespace evod::viewer
