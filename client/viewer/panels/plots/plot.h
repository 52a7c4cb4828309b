// Plot: series over axes, drawn on Dear ImGui's draw list: in a window, where it can be zoomed and read, or on a
// picture.
//
// Threads      none; used by the thread that draws.
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
        Dashes, // a line, of what is compared
        Band,   // from `low` to `y`
        Stack,  // bars, each upon the stacks before it; of a long series the mean of what falls into a column
        Bars,   // on the axis
    };
    Kind kind = Kind::Line;
    std::string name{}; // in the legend
    Colour colour{};
    std::span<const double> x{}; // rising
    std::span<const double> y{}; // as many; what is not finite is left out
    std::span<const double> low{};
    double bar_width = 1; // of stacks and bars, in the units of x
};

struct Plot {
    std::string title{};              // of a picture and of curves; else its place tells what it is
    std::string x_label{}, y_label{}; // y_label with its unit
    std::vector<Series> series{};     // the first at the back
    bool from_zero = false;           // the y axis begins at 0, if nothing is below it
    bool counted_x = false;           // x is whole numbers, and nothing stands between them
};

/// What of the x axis is shown.
struct PlotView {
    std::optional<Range> x; // nullopt: all
};

/// The range of all its series.
Range whole_x(const Plot& plot);

/// A widget as wide as the window: the wheel zooms along the x axis, dragging moves, a double click fits; the number
/// under the mouse is told. Several plots may share a view.
void plot_widget(const char* id, const Plot& plot, PlotView& view, float height_pixels);

/// The lines alone, as wide as the window, with the title in a corner; what is beyond `y` is cut off.
void curve_widget(const Plot& plot, Range y, float height_pixels);

/// The same as plot_widget as a picture, with its title. Between Gui::begin() and Gui::draw(); throws
/// std::runtime_error if a picture of this size cannot be drawn.
sf::Image picture_of(const Plot& plot, const PlotView& view, unsigned width_pixels, unsigned height_pixels);

} // namespace evod::viewer
