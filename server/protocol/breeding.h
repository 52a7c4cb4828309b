// Breeding: converts the record of a breeding into a message.
#pragma once

#include "evod/v1/commands.pb.h"
#include "server/evolution/breeding_record.h"
#include "server/parameters/model_parameters.h"

namespace evod::protocol {

/// Maximum number of rows in each list of a Breeding.
constexpr std::uint32_t breeding_rows_max = 1000;

evolution::WantedRows wanted_rows(const v1::GetBreeding& request);

/// Converts the record of a breeding. `parameters` are those that were active when the generation bred.
v1::Breeding to_proto(const evolution::BreedingRecord& record, const parameters::Parameters& parameters);

} // namespace evod::protocol
