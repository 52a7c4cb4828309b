// What of a wheel can be seen: its slots as arcs, those narrower than a pixel together.
//
// Threads      none.
#pragma once

#include "client/viewer/drawing/palette.h"
#include "evod/v1/commands.pb.h"

#include <google/protobuf/repeated_field.h>

#include <cstdint>
#include <vector>

namespace evod::viewer {

using Contenders = google::protobuf::RepeatedPtrField<evod::v1::Contender>;

struct Arc {
    double begin = 0, end = 0;         // in turns, 0 to 1
    std::uint32_t first = 0, last = 0; // organisms: the slots from one to the other
    double rank = 0;                   // of the organism; of several their mean, each as much as its slot is wide
};

/// The slots in order, those of no width left out. Neighbours narrower than a pixel become one arc, a pixel wide or
/// more.
///
/// circumference_px  > 0
std::vector<Arc> wheel_arcs(const Contenders& contenders, double circumference_px);

/// The organism whose slot `turns` lies in, or nullptr: the slot is of one that is not known.
const evod::v1::Contender* slot_at(const Contenders& contenders, double turns);

/// Light for the fittest to dark for the last: told apart by lightness, with every kind of colour vision.
Colour rank_colour(double rank, std::uint32_t contender_count);

} // namespace evod::viewer
