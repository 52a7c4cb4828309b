// Layout of a plot: ticks, and which points of a long series are drawn.
//
// Threads      none.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace evod::viewer {

struct Range {
    double min = 0, max = 1;

    double width() const { return max - min; }
    bool contains(double value) const { return value >= min && value <= max; }
    friend bool operator==(const Range&, const Range&) = default;
};

/// The least range with all finite ones of the numbers in it; nullopt if there are none.
std::optional<Range> range_of(std::span<const double> numbers);
std::optional<Range> joined(std::optional<Range> a, std::optional<Range> b);

/// A range that can be drawn: wider than the digits of a double, and with a little room at either end.
Range with_room(Range range, double room_share);

struct Ticks {
    double step = 1;
    std::vector<double> at; // rising
};
/// Round numbers, 1, 2 or 5 times a power of ten apart, inside of the range; at most `count_max` of them.
///
/// step_min  how far apart at least: 1 for what is counted
Ticks ticks_in(Range range, int count_max, double step_min = 0);

/// With as many decimals as the step needs: "1,500", "0.25", "1.5e+20".
std::string tick_label(double tick, double step);

/// Zooms so that the point at `share` of the way stays where it is; factor > 1 shows less. Neither leaves `whole`.
Range zoomed(Range shown, double share, double factor, Range whole, double width_min);
/// Moves by so much, and not out of `whole`.
Range moved(Range shown, double by, Range whole);

// ---- long series -----------------------------------------------------------------------------------------------

/// Numbers begin to end - 1 of a series, which are drawn in one column of pixels.
struct Group {
    std::size_t begin, end;
};

/// Splits the part of a series that is shown, and the next number on either side of it, into columns of pixels; with
/// no more than two numbers for each column, every number is a group of its own.
/// x  rising.
std::vector<Group> groups_of(std::span<const double> x, Range shown, std::size_t columns);

/// A point of a line; one without a number parts it.
struct LinePoint {
    double x, y;
};
/// The line through the numbers, drawn by at most four points in each column: its first, least, greatest and last one,
/// so that no peak is lost.
std::vector<LinePoint> line_of(std::span<const double> x, std::span<const double> y, std::span<const Group> groups);

/// Least of `low` and greatest of `high` in each group; groups without a number are left out.
struct BandPoint {
    double x, low, high;
};
std::vector<BandPoint> band_of(std::span<const double> x, std::span<const double> low, std::span<const double> high,
                               std::span<const Group> groups);

/// Mean of the finite numbers in a group; 0 if there are none.
double mean_of(std::span<const double> y, Group group);

/// Index of the number that is next to `at`; nullopt if there are none.
std::optional<std::size_t> nearest(std::span<const double> x, double at);

/// How many of the numbers are in each of `count` bins of equal width over the range; those outside are in none, and
/// the upper end is in the last one.
std::vector<double> histogram(std::span<const float> numbers, Range range, std::size_t count);

} // namespace evod::viewer
