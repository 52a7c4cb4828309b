// Quantise: converts an island of a snapshot into the input of the encoders: whole numbers, ordered by id.
//
// The simulation thread copies columns in the order of memory. The network thread sorts and rounds them here, so that
// this work does not delay the simulation.
#pragma once

#include "proto/codec/quantised_snapshot.h"
#include "server/runtime/snapshot.h"

#include <compare>

namespace evod::streaming {

/// What an encoding of organisms contains only if a viewer wants it, and if the organisms have it.
struct OptionalColumns {
    bool headings = false, species = false;
    friend auto operator<=>(const OptionalColumns&, const OptionalColumns&) = default;
};

codec::QuantisedSnapshot quantise(const runtime::IslandSnapshot& island, OptionalColumns with = {});

} // namespace evod::streaming
