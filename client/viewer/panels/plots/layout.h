// Layout of a plot: ticks, zoom, and the points of a long series that are drawn.
//
// Owner        none: pure functions.
// Threads      any.
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

/// The smallest range that contains all finite numbers; nullopt if there are none.
std::optional<Range> range_of(std::span<const double> numbers);
std::optional<Range> joined(std::optional<Range> a, std::optional<Range> b);

/// Widens a range so that it can be drawn: wider than the rounding of a double, with `room_share` more at each end.
Range with_room(Range range, double room_share);

struct Ticks {
    double step = 1;
    std::vector<double> at; // rising
};
/// At most `count_max` round numbers inside the range, at a distance of 1, 2 or 5 times a power of ten.
///
/// step_min  least distance: 1 for counts
Ticks ticks_in(Range range, int count_max, double step_min = 0);

/// A tick with as many decimals as the step needs: "1,500", "0.25", "1.5e+20".
std::string tick_label(double tick, double step);

/// Zooms around the point at `share` of the range, which stays in place; factor > 1 shows less. Stays inside `whole`.
Range zoomed(Range shown, double share, double factor, Range whole, double width_min);
/// Shifts the range, limited to `whole`.
Range moved(Range shown, double by, Range whole);

// ---- long series -----------------------------------------------------------------------------------------------

/// Numbers begin to end - 1 of a series, drawn in one column of pixels.
struct Group {
    std::size_t begin, end;
};

/// Splits the visible part of a series, and the next number on either side of it, into columns of pixels. With at most
/// two numbers per column, every number is a group of its own.
/// x  rising.
std::vector<Group> groups_of(std::span<const double> x, Range shown, std::size_t columns);

/// A point of a line; a point whose y is NaN splits the line.
struct LinePoint {
    double x, y;
};
/// The line through the numbers with at most four points per column (the first, least, greatest and last), so that no
/// peak is lost.
std::vector<LinePoint> line_of(std::span<const double> x, std::span<const double> y, std::span<const Group> groups);

/// Least of `low` and greatest of `high` in each group; groups without a finite number are left out.
struct BandPoint {
    double x, low, high;
};
std::vector<BandPoint> band_of(std::span<const double> x, std::span<const double> low, std::span<const double> high,
                               std::span<const Group> groups);

/// The mean of the finite numbers in a group; 0 if there are none.
double mean_of(std::span<const double> y, Group group);

/// The index of the number nearest to `at`; nullopt if `x` is empty.
std::optional<std::size_t> nearest(std::span<const double> x, double at);

/// Counts the numbers in each of `count` bins of equal width over the range. Numbers outside are not counted; the upper
/// end belongs to the last bin.
std::vector<double> histogram(std::span<const float> numbers, Range range, std::size_t count);

} // namespace evod::viewer
