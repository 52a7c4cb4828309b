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
    float normal_x = 0, normal_y = 0; // unit vector from the first shape toward the second
};

struct BoxShape {
    float half_width, half_height; // px
};

/// Tests two circles. If their centres are equal, depth is the sum of the radii, and the normal is +x.
///
/// dx, dy  second centre − first centre, px.
Overlap circle_circle(float dx, float dy, float first_radius, float second_radius);

/// Tests two boxes. The normal is along the axis with the smaller overlap: along x if both overlaps are equal. If the
/// centres are equal on that axis, the normal is positive.
///
/// dx, dy  second centre − first centre, px.
Overlap box_box(float dx, float dy, BoxShape first, BoxShape second);

/// Tests a box (first) and a circle (second). If the circle's centre is inside the box or on its edge, the normal
/// points to the nearest side of the box, and depth is the distance to that side plus the radius. Of equally near
/// sides, the left and right ones are preferred, then the one in positive direction.
///
/// dx, dy  circle's centre − box's centre, px.
Overlap box_circle(float dx, float dy, BoxShape box, float radius);

} // namespace evod::physics
