// Plot layout: computes axis ticks, the zoomed range, running means, the points with which a long series is drawn, the
// marks, and the place of the note beside a plot.
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

/// A position, or a size, in pixels.
struct Corner {
    float x, y;
    friend bool operator==(const Corner&, const Corner&) = default;
};

struct Range {
    double min = 0, max = 1;

    double width() const { return max - min; }
    bool contains(double value) const { return value >= min && value <= max; }
    friend bool operator==(const Range&, const Range&) = default;
};

/// Returns the smallest range that contains all finite numbers; nullopt if there is none.
std::optional<Range> range_of(std::span<const double> numbers);
std::optional<Range> joined(std::optional<Range> a, std::optional<Range> b);

/// Widens a range by `room_share` of its width at each end, and at least enough that rounding errors are not visible.
Range with_room(Range range, double room_share);

struct Ticks {
    double step = 1;
    std::vector<double> at; // in increasing order
};
/// Returns at most `count_max` round numbers inside the range. Their distance is 1, 2 or 5 times a power of ten.
///
/// step_min  least distance between two ticks; 1 for counts
Ticks ticks_in(Range range, int count_max, double step_min = 0);

/// Returns the text of a tick, with as many decimals as `step` requires: "1,500", "0.25", "1.5e+20".
std::string tick_label(double tick, double step);

/// Zooms a range; factor > 1 shows a smaller part. The point at `share` of the range keeps its place. The result lies
/// inside `whole`.
Range zoomed(Range shown, double share, double factor, Range whole, double width_min);
/// Shifts the range by `by`, limited to `whole`.
Range moved(Range shown, double by, Range whole);

// ---- long series -----------------------------------------------------------------------------------------------

/// The numbers with indices begin to end - 1 of a series. They are drawn in one column of pixels.
struct Group {
    std::size_t begin, end;
};

/// Divides the numbers of the visible part of a series, and one more number at each end, into one group per column of
/// pixels. If there are at most two numbers per column, every number is a group of its own.
///
/// x  in increasing order.
std::vector<Group> groups_of(std::span<const double> x, Range shown, std::size_t columns);

/// A point of a line. A point whose y is NaN interrupts the line.
struct LinePoint {
    double x, y;
};
/// Returns the line through the numbers. Each group contributes at most four points (the first, least, greatest and
/// last number), so that no peak is lost.
std::vector<LinePoint> line_of(std::span<const double> x, std::span<const double> y, std::span<const Group> groups);

/// A point of a band: the least value of `low` and the greatest value of `high` in a group. A group without a finite
/// number has no point.
struct BandPoint {
    double x, low, high;
};
std::vector<BandPoint> band_of(std::span<const double> x, std::span<const double> low, std::span<const double> high,
                               std::span<const Group> groups);

/// Returns, for each finite number, the mean of the finite numbers among it and the `window` - 1 numbers before it; NaN
/// for other numbers. Later numbers have no influence, so an effect never appears before its cause.
///
/// window  >= 1
std::vector<double> running_mean(std::span<const double> y, std::size_t window);

/// Returns the mean of the finite numbers in a group; 0 if there is none.
double mean_of(std::span<const double> y, Group group);

/// Returns the index of the number in `x` that is nearest to `at`; nullopt if `x` is empty.
std::optional<std::size_t> nearest(std::span<const double> x, double at);

/// Counts the numbers in each of `count` bins of equal width. Numbers outside the range are not counted. The upper end
/// of the range belongs to the last bin.
std::vector<double> histogram(std::span<const float> numbers, Range range, std::size_t count);

// ---- marks and notes -------------------------------------------------------------------------------------------

/// A vertical line in a plot, with the text that explains it.
struct Mark {
    double x;
    std::string text;
};

/// Divides the visible marks into groups that are drawn as one line, at the first mark of the group.
///
/// marks     in order of x
/// distance  marks of a group are nearer than this to its first mark, in units of x
std::vector<Group> mark_groups(std::span<const Mark> marks, Range shown, double distance);

struct Box {
    float left, top, right, bottom;
};

/// Returns the upper left corner of a note of this size beside a plot: on its left side, or else where there is room:
/// on the right, above or below. The note never covers the plot if the window has room anywhere beside it.
///
/// y  height of the mouse, at which the note is centred
Corner note_place(Box plot, Corner size, float y, Corner window);

} // namespace evod::viewer
