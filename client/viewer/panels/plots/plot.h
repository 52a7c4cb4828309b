// Plot: draws series over axes with Dear ImGui, as a widget in which the user can zoom and read numbers, or as an
// image.
//
// ImPlot would draw the axes and the lines, but Debian 12 has no package of it, and it neither reduces long series to
// their peaks per pixel nor draws images off the screen.
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
        Dashes, // a dashed line, for the compared history
        Band,   // an area between `low` and `y`
        Stack,  // bars on top of the preceding stacks; a long series shows the mean per column of pixels
        Bars,   // bars that begin at the axis
    };
    Kind kind = Kind::Line;
    std::string name{};   // name in the note; empty: the note omits the series
    std::string newest{}; // text after the name in the legend
    bool in_legend = true;
    Colour colour{};
    std::span<const double> x{}; // in increasing order
    std::span<const double> y{}; // same length as x; numbers that are not finite are not drawn
    std::span<const double> low{};
    std::span<const double>
        raw{};            // the numbers of which `y` is the running mean, drawn faintly; empty: `y` is drawn alone
    double bar_width = 1; // for stacks and bars, in the units of x
    bool whole = false;   // the numbers are counts: the note shows all their digits
};

/// The marks of one history.
struct Marks {
    std::span<const Mark> marks{};
    std::string name{}; // name of the history in the note; empty: there is only one
};

struct Plot {
    std::string title{};              // drawn only on images and by curve_widget()
    std::string x_label{}, y_label{}; // y_label contains the unit
    std::string note_end{};           // the last line of the note under the mouse
    std::vector<Series> series{};     // each is drawn over the ones after it, but stacks are drawn below all others
    std::vector<Marks> marks{};
    std::string solid{}, dashed{}; // what solid and dashed lines show, for the legend; empty: nothing to distinguish
    std::string smoothed{};        // how the note names a running mean: "mean of 10"
    bool from_zero = false;        // the y axis starts at 0 unless a number is negative
    bool counted_x = false;        // x contains whole numbers: no ticks between them
};

/// The visible part of the x axis.
struct PlotView {
    std::optional<Range> x; // nullopt: the whole axis
};

/// Returns the x range of all series together.
Range whole_x(const Plot& plot);

/// Draws the plot in a widget as wide as the window. The wheel zooms along the x axis, dragging moves the visible part,
/// and a double click shows the whole axis. A note beside the plot shows the numbers and the marks under the mouse.
/// Several plots may share a view.
void plot_widget(const char* id, const Plot& plot, PlotView& view, float height_pixels);

/// Draws only the lines and marks, as wide as the window and clipped to the range `y`, with the title and the names of
/// the series in a row at the top. A note as in plot_widget() appears if the plot has an x_label.
///
/// returns  the x of the numbers that the user has clicked; nullopt: there was no click, or there are no numbers
std::optional<double> curve_widget(const char* id, const Plot& plot, Range y, float height_pixels);

/// Draws the plot as plot_widget() does, with its title, and returns it as an image. Call it between Gui::begin() and
/// Gui::draw(). Throws std::runtime_error if the graphics driver cannot draw an image of this size.
sf::Image image_of(const Plot& plot, const PlotView& view, unsigned width_pixels, unsigned height_pixels);

} // namespace evod::viewer
