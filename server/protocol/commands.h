// Converts requests into commands that are valid in themselves, and checks all other requests.
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
constexpr std::uint32_t unacknowledged_snapshots_max = 1000; // of an island, for one subscription
constexpr std::uint64_t view_bytes_per_s_least = 1000, view_bytes_per_s_most = 1'000'000'000'000;

/// Random values that a request may need; the caller draws them.
struct Draws {
    base::Seed seed;
    simulation::RunId run_id;
};

/// The command, or everything that is wrong with the request. Laboratory::apply checks what depends on the state of the
/// world.
///
/// request  of REQUEST_KIND_COMMAND.
base::Result<simulation::Command> to_command(const v1::Request& request, const Draws& draws);

/// Path and number of the first unknown field at any depth: "set_parameters.99". The server refuses such a command,
/// because it might do something else without that field.
std::optional<std::string> unknown_field_of(const google::protobuf::Message& message);

/// The invalid fields of a query, subscription, replay or export request, as far as the request alone shows.
std::vector<base::Violation> faults_of(const v1::Request& request);

/// A world name for a lookup. Text that cannot be a world name is shortened to what a message may contain.
std::string lookup_name(const std::string& world);

/// INVALID_ARGUMENT with every invalid field.
base::Refusal invalid(std::vector<base::Violation> violations);

} // namespace evod::protocol
