// Requests that change something → commands that cannot be wrong in themselves.
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
constexpr std::uint32_t unacknowledged_snapshots_max = 1000; // of an island, that a subscription may ask for
constexpr std::uint64_t view_bytes_per_s_least = 1000, view_bytes_per_s_most = 1'000'000'000'000;

/// What a request may need that is drawn by chance; drawn by the caller.
struct Draws {
    base::Seed seed;
    simulation::RunId run_id;
};

enum class RequestKind { Command, Query, Subscription, Past, Export, Lease, Server, Unknown };
RequestKind kind_of(const v1::Request& request);

/// The command, or everything that is wrong with the request. What depends on the world's state is left to
/// Laboratory::apply.
///
/// request  of RequestKind::Command.
base::Result<simulation::Command> to_command(const v1::Request& request, const Draws& draws);

/// Path and number of the first field that this server does not know, at any depth: "set_parameters.99". Such a command is
/// refused, because without that field it might do something else than its sender meant.
std::optional<std::string> unknown_field_of(const google::protobuf::Message& message);

/// What is wrong with a request that only reads or subscribes, as far as the request alone tells.
std::vector<base::Violation> faults_of(const v1::Request& request);

/// A name to look a world up by: one that cannot be a world's is cut to what may stand in a message.
std::string lookup_name(const std::string& world);

/// INVALID_ARGUMENT, naming every field.
base::Refusal invalid(std::vector<base::Violation> violations);

} // namespace evod::protocol
