// Shapes: exact overlap tests of two shapes, given the offset between their centres.
//
// Each test returns whether the shapes touch, how deeply they overlap, and the normal of least penetration: a vector of
// length 1 from the first shape toward the second. Shapes that share a single point touch, with depth 0.
// Source  Ericson 2005, Real-Time Collision Detection, ch. 4–5.
#pragma once

namespace evod::physics {

struct Overlap {
    bool touching = false;
    float depth = 0;                  // px, >= 0
    float normal_x = 0, normal_y = 0; // the normal, from the first shape to the second
};

struct BoxShape {
    float half_width, half_height; // px
};

/// dx, dy  second centre − first centre, px. If the centres are equal, depth is the sum of the radii and the normal is
///         +x.
Overlap circle_circle(float dx, float dy, float first_radius, float second_radius);

/// dx, dy  second centre − first centre, px. If both overlaps are equal, the x axis wins; if the centres are equal too,
///         the normal is positive.
Overlap box_box(float dx, float dy, BoxShape first, BoxShape second);

/// dx, dy  circle's centre − box's centre, px. If the centre is inside the box or on its edge, the normal points to the
///         nearest side, and depth is the distance to that side plus the radius. If sides are equally near, the x axis
///         wins, then the positive side.
Overlap box_circle(float dx, float dy, BoxShape box, float radius);

} // namespace evod::physics
