// Status texts: texts in the strips, notices and messages of the window about a world, its server and its run.
//
// Threads      none; pure functions.
#pragma once

#include "client/core/connection.h"
#include "client/viewer/text/numbers.h"
#include "client/viewer/world/run_control.h"

#include <string>
#include <vector>

namespace evod::viewer {

std::string capitalised(std::string text);            // "the server is …" → "The server is …"
std::string speed_text(double factor);                // times real time: "4×", "1/4×"
std::string speed_text(const evod::v1::Speed& speed); // "4×", "1/4×", "max"
/// Returns the run state with a hint: "running", "waiting – Space runs". A running world may have to wait for the
/// server's disk (`storage`), or for fitness from clients.
const char* state_text(evod::v1::RunState state, const evod::v1::Storage& storage, bool awaits_fitness);
/// Returns the run state without the hint: "waiting".
const char* state_word(evod::v1::RunState state, const evod::v1::Storage& storage, bool awaits_fitness);

/// Returns the problem with the server's run files: "Commands are refused: …", "Worlds wait for the disk: …". Empty if
/// there is none.
std::string storage_text(const evod::v1::Storage& storage);

/// Returns the refusal on one line: "No such island: island: got 9, allowed 0 to 7".
std::string refusal_text(const evod::v1::Status& status);

/// Returns why there is no connection, as a sentence to be shown beside the fields for server and token. Empty if there
/// is no problem.
std::string connection_loss_text(const core::ConnectionStatus& status, bool has_token);

/// Returns the title of a snapshot: "Generation 12".
std::string generation_title(const evod::v1::SnapshotFrame& snapshot);

/// Returns the label of a replay: "REPLAY of default" for a replay of a live world, "REPLAY" for one of a run file.
std::string replay_label(const evod::v1::Replay& replay);

/// Returns what the window shows: "World default", "Replay of default, generation 12", "Replay of a file, generation
/// 12".
std::string shown_text(const std::string& world, const evod::v1::Replay* replay,
                       const evod::v1::SnapshotFrame* snapshot);

/// Returns the world and island of a snapshot: "default · island 2 of 0–7".
///
/// world  the name of the world; of a replay, the name of its live world
std::string place_text(const std::string& world, const evod::v1::SnapshotFrame& snapshot);
/// Returns the world, island and speed: "default · island 2 of 0–7 · 4× (240 ticks/s)".
std::string place_and_speed_text(const std::string& world, const evod::v1::SnapshotFrame& snapshot,
                                 const RunControl& control);

/// Returns the parts of the statistics line, the most important first. A narrow window omits the last parts.
std::vector<std::string> statistics_texts(const evod::v1::SnapshotFrame& snapshot,
                                          const evod::v1::GenerationStatistics* last_generation);

} // namespace evod::viewer
