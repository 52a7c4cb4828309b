// Wheel layout: the slots of a selection wheel as arcs to draw. Neighbouring slots narrower than a pixel are merged.
//
// Owner        none: values.
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
    double begin = 0, end = 0;         // angles in turns, 0 to 1
    std::uint32_t first = 0, last = 0; // ids of the first and the last organism
    double rank = 0;                   // rank of the organism; for several, the mean weighted by slot width
};

/// Returns the arcs in the order of the slots, without slots of width 0. Neighbouring slots narrower than a pixel are
/// merged into arcs that are at least a pixel wide.
///
/// circumference_px  circumference of the wheel in pixels, > 0
std::vector<Arc> wheel_arcs(const Contenders& contenders, double circumference_px);

/// Returns the organism whose slot contains the angle `turns`; nullptr if the server has not sent it yet.
const evod::v1::Contender* slot_at(const Contenders& contenders, double turns);

/// Returns the colour of a rank: light for the fittest, dark for the lowest rank. Lightness alone encodes the rank, so
/// it is visible with every kind of colour vision.
Colour rank_colour(double rank, std::uint32_t contender_count);

} // namespace evod::viewer
