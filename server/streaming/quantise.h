// Quantise: converts an island of a snapshot into the input of the encoders: whole numbers, ordered by id.
//
// The simulation thread copies columns in the order of memory. The network thread sorts and rounds them here, so that
// this work does not delay the simulation.
#pragma once

#include "proto/codec/quantised_snapshot.h"
#include "server/runtime/snapshot.h"

namespace evod::streaming {

/// with_headings  whether organisms that have a heading keep it.
codec::QuantisedSnapshot quantise(const runtime::IslandSnapshot& island, bool with_headings = false);

} // namespace evod::streaming
