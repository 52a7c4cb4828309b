// Scene: an island of a snapshot as encoders take it, in whole numbers, and entities by rising id.
//
// The simulation thread copies columns as they lie. What lies there is put in order here, on the network thread, where
// it keeps nobody from simulating.
#pragma once

#include "proto/codec/quantised_snapshot.h"
#include "server/runtime/snapshot.h"

namespace evod::streaming {

codec::QuantisedSnapshot quantise(const runtime::IslandSnapshot& island);

} // namespace evod::streaming
