// Quantise: an island of a snapshot in the form that encoders take, with whole numbers and ids rising.
//
// The simulation thread copies columns in memory order. The network thread sorts and rounds them here, so that this does not
// delay the simulation.
#pragma once

#include "proto/codec/quantised_snapshot.h"
#include "server/runtime/snapshot.h"

namespace evod::streaming {

codec::QuantisedSnapshot quantise(const runtime::IslandSnapshot& island);

} // namespace evod::streaming
