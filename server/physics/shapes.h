// Shapes: exact tests of two shapes against each other, at a given distance between their centres.
//
// Each says whether they touch, how deep they overlap, and the normal of least penetration, from the first shape toward
// the second, of length 1. Shapes that share a single point touch, with depth 0.
// Source  Ericson 2005, Real-Time Collision Detection, ch. 4–5.
#pragma once

namespace evod::physics {

struct Overlap {
    bool touching = false;
    float depth = 0;                  // px, >= 0
    float normal_x = 0, normal_y = 0; // from the first to the second
};

struct BoxShape {
    float half_width, half_height; // px
};

/// dx, dy  second centre − first centre, px. Equal centres: depth is the sum of the radii, normal +x.
Overlap circle_circle(float dx, float dy, float first_radius, float second_radius);

/// dx, dy  second centre − first centre, px. Of equal overlaps the x axis wins; equal centres: normal +x or +y.
Overlap box_box(float dx, float dy, BoxShape first, BoxShape second);

/// dx, dy  circle's centre − box's centre, px. A centre inside the box, or on its edge, leaves by the nearest side:
/// depth is the way to it plus the radius; of equally near sides the x axis wins, then +.
Overlap box_circle(float dx, float dy, BoxShape box, float radius);

} // namespace evod::physics
