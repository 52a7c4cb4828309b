// Styles: how each mark of an island is drawn in each look. The island and the legends use the same styles.
//
// Owner        none: constants.
// Threads      any.
#pragma once

#include "client/viewer/drawing/palette.h"
#include "client/viewer/island/shapes.h"

namespace evod::viewer {

struct Styles {
    ShapeStyle organism;             // without a colouring
    ShapeStyle coloured;             // with a colour of its own
    ShapeStyle predator;             // with and without a colouring
    ShapeStyle organism_dot;         // streamed without radius and health
    ShapeStyle food_dot, poison_dot; // among organisms that are too small to see one by one
    ShapeStyle pointed_at, selected;
    float highlight_pixels; // from the outline of an organism to the two rings above, at scale 1
    ShapeStyle heading;     // of organisms that have one
    ShapeStyle food, poison, crate, obstacle;
    ShapeStyle food_radius, poison_radius, arrow, target;
    ShapeStyle trail, shadow; // the shadow of the walls on the outside
    ShapeStyle ripple;        // a meal or a death
    float heading_pixels;     // from the outline of an organism to the end of its heading, at scale 1
    float label_zoom_min;     // at a smaller zoom, only highlighted organisms have numbers
};

const Styles& styles_of(Look look);

} // namespace evod::viewer
