// Converts requests into commands, and checks every field of a request that can be checked without the state of the
// world.
#pragma once

#include "evod/v1/commands.pb.h"
#include "server/base/random.h"
#include "server/base/result.h"
#include "server/simulation/commands.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace evod::protocol {

constexpr std::size_t client_key_bytes_max = 64;
constexpr std::size_t note_kind_bytes_max = 32, note_text_bytes_max = 4096;
constexpr std::uint32_t unacknowledged_snapshots_max = 1000; // maximum per island and subscription
constexpr std::uint64_t view_bytes_per_s_least = 1000, view_bytes_per_s_most = 1'000'000'000'000;

/// Random values that a request may need. The caller generates them.
struct Draws {
    base::Seed seed;
    simulation::RunId run_id;
};

/// Returns the command, or a refusal that lists every error in the request. Laboratory::apply() later checks everything
/// that depends on the state of the world.
///
/// request  its kind is REQUEST_KIND_COMMAND.
base::Result<simulation::Command> to_command(const v1::Request& request, const Draws& draws);

/// Returns the path and number of the first unknown field at any depth: "set_parameters.99". The server refuses a
/// command with an unknown field, because without that field the command might have a different effect.
std::optional<std::string> unknown_field_of(const google::protobuf::Message& message);

/// Checks the fields of a query, subscription, replay or export request without the state of the world. Returns the
/// invalid ones.
std::vector<base::Violation> faults_of(const v1::Request& request);

/// Returns the name by which the laboratory looks up a world. If the text is not a valid name, it is made safe for
/// messages with quotable(), so that a refusal can contain it.
std::string lookup_name(const std::string& world);

/// Returns a refusal with INVALID_ARGUMENT that lists every invalid field.
base::Refusal invalid(std::vector<base::Violation> violations);

} // namespace evod::protocol
