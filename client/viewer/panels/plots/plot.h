// Plot: series over axes, drawn with Dear ImGui: as a widget that the user can zoom and read, or as an image.
//
// Owner        PlotsPanel.
// Threads      none; used on the drawing thread.
#pragma once

#include "client/viewer/drawing/palette.h"
#include "client/viewer/panels/plots/layout.h"

#include <SFML/Graphics/Image.hpp>

#include <optional>
#include <span>
#include <string>
#include <vector>

struct ImDrawList;
struct ImFont;

namespace evod::viewer {

struct Series {
    enum class Kind {
        Line,
        Dashes, // a line of the compared history
        Band,   // from `low` to `y`
        Stack,  // bars on top of the stacks before; a long series shows the mean per column of pixels
        Bars,   // from the axis
    };
    Kind kind = Kind::Line;
    std::string name{}; // in the legend
    Colour colour{};
    std::span<const double> x{}; // rising
    std::span<const double> y{}; // same length; numbers that are not finite are left out
    std::span<const double> low{};
    double bar_width = 1; // of stacks and bars, in the units of x
};

struct Plot {
    std::string title{};              // drawn on images and curves only
    std::string x_label{}, y_label{}; // y_label with its unit
    std::vector<Series> series{};     // the first is drawn first
    bool from_zero = false;           // the y axis starts at 0 unless a number is negative
    bool counted_x = false;           // x is whole numbers: no ticks between them
};

/// The visible part of the x axis.
struct PlotView {
    std::optional<Range> x; // nullopt: all
};

/// The x range of all series together.
Range whole_x(const Plot& plot);

/// A widget as wide as the window. The wheel zooms along the x axis, dragging moves, a double click fits, and a note
/// shows the numbers under the mouse. Several plots may share a view.
void plot_widget(const char* id, const Plot& plot, PlotView& view, float height_pixels);

/// Only the lines, as wide as the window, with the title in a corner; clipped to the range `y`.
void curve_widget(const Plot& plot, Range y, float height_pixels);

/// The same as plot_widget() as an image, with the title. Call it between Gui::begin() and Gui::draw(). Throws
/// std::runtime_error if the graphics driver cannot draw an image of this size.
sf::Image image_of(const Plot& plot, const PlotView& view, unsigned width_pixels, unsigned height_pixels);

} // namespace evod::viewer
