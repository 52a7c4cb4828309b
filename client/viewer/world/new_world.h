// New world: the request that creates a world from what a user typed and chose, and the names of worlds.
//
// Owner        none: functions.
// Threads      any.
#pragma once

#include "client/core/client_types.h"
#include "evod/v1/commands.pb.h"

#include "proto/codec/population_csv.h"

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace evod::viewer {

/// Returns why this text cannot name a world or a frozen file, as "FIELD: got "…", allowed …"; empty if it can.
std::string name_problem(std::string_view field, std::string_view name);

/// Returns a name that `used` does not contain: `base` itself, or `base` with the smallest number from 2 that is free:
/// "default-2". A number at the end of `base` is replaced: "default-2" leads to "default-3", not to "default-2-2".
std::string unused_name(std::string_view base, std::span<const std::string> used);

/// Returns the parameters of a world as the text of an experiment file: the values that a reset would use, and the
/// values that the schedule assigns in later generations.
std::string experiment_json(const evod::v1::ParameterSet& set);

/// What a user chose for a new world.
struct NewWorldForm {
    std::string name{};
    std::string seed{}; // empty: the server chooses one
    std::string experiment_json{};
    /// The genes of the first generation, one row per island, organism by organism; empty: drawn from the seed.
    codec::Population population{};
};

/// Returns the request, or an error of kind Usage that begins with the name of the field. With a population, the
/// request also sets `population_size` and `island_count` to the numbers of the population.
core::Result<evod::v1::Request> create_request(const NewWorldForm& wanted);

} // namespace evod::viewer
