#include "client/viewer/panels/plots/layout.h"

#include "client/viewer/text/numbers.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace evod::viewer {

std::optional<Range> range_of(std::span<const double> numbers) {
    std::optional<Range> range;
    for (const double number : numbers) {
        if (std::isfinite(number)) {
            range = range ? Range{std::min(range->min, number), std::max(range->max, number)} : Range{number, number};
        }
    }
    return range;
}

std::optional<Range> joined(std::optional<Range> a, std::optional<Range> b) {
    return !a ? b : !b ? a : std::optional{Range{std::min(a->min, b->min), std::max(a->max, b->max)}};
}

Range with_room(Range range, double room_share) {
    // Computes half the width, because the whole width of a range of doubles can overflow.
    const double middle = range.min / 2 + range.max / 2;
    const double least = std::max(std::abs(middle) * 1e-9, 1e-12);
    const double half = std::min(std::max((range.max / 2 - range.min / 2) * (1 + 2 * room_share), least), 4e307);
    return {std::max(middle, -4e307) - half, std::min(middle, 4e307) + half};
}

Ticks ticks_in(Range range, int count_max, double step_min) {
    Ticks ticks;
    const double rough = range.width() / std::max(count_max, 1);
    if (!(rough > 0) || !std::isfinite(rough)) {
        return ticks;
    }
    for (ticks.step = nice_step(std::max(rough / 2, step_min));; ticks.step = nice_step(1.5 * ticks.step)) {
        const double first = std::ceil(range.min / ticks.step - 1e-9), last = std::floor(range.max / ticks.step + 1e-9);
        if (last - first + 1 <= count_max) {
            for (double number = first; number <= last; ++number) {
                ticks.at.push_back(number == 0 ? 0 : number * ticks.step);
            }
            return ticks;
        }
    }
}

std::string tick_label(double tick, double step) {
    const double size = std::max(std::abs(tick), step);
    if (size >= 1e9 || size < 1e-5) {
        return with_separators(print("%.6g", tick));
    }
    const int decimals = std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9)));
    return with_separators(print("%.*f", std::min(decimals, 12), tick));
}

Range moved(Range shown, double by, Range whole) {
    by = std::clamp(by, whole.min - shown.min, std::max(whole.max - shown.max, whole.min - shown.min));
    return {shown.min + by, shown.max + by};
}

Range zoomed(Range shown, double share, double factor, Range whole, double width_min) {
    const double at = shown.min + share * shown.width();
    const double least = std::min(width_min, whole.width());
    const double width = std::clamp(shown.width() / factor, least, whole.width());
    const double begin = at - share * width;
    return moved({begin, begin + width}, 0, whole);
}

// ---- long series -----------------------------------------------------------------------------------------------

std::vector<Group> groups_of(std::span<const double> x, Range shown, std::size_t columns) {
    auto begin = static_cast<std::size_t>(std::lower_bound(x.begin(), x.end(), shown.min) - x.begin());
    auto end = static_cast<std::size_t>(std::upper_bound(x.begin(), x.end(), shown.max) - x.begin());
    begin -= begin > 0 ? 1 : 0;
    end += end < x.size() ? 1 : 0;
    std::vector<Group> groups;
    if (end - begin <= 2 * columns || !(shown.width() > 0)) {
        for (std::size_t i = begin; i < end; ++i) {
            groups.push_back({i, i + 1});
        }
        return groups;
    }
    const double per_column = static_cast<double>(columns) / shown.width();
    double column = 0;
    for (std::size_t i = begin; i < end; ++i) {
        const double here = std::floor((x[i] - shown.min) * per_column);
        if (groups.empty() || here != column) {
            groups.push_back({i, i});
            column = here;
        }
        groups.back().end = i + 1;
    }
    return groups;
}

std::vector<LinePoint> line_of(std::span<const double> x, std::span<const double> y, std::span<const Group> groups) {
    std::vector<LinePoint> line;
    const auto add = [&](std::size_t i) {
        if (line.empty() || line.back().x != x[i] || line.back().y != y[i]) {
            line.push_back({x[i], y[i]});
        }
    };
    for (const Group group : groups) {
        std::optional<std::size_t> first, last, least, greatest;
        bool split = false;
        for (std::size_t i = group.begin; i < group.end; ++i) {
            if (!std::isfinite(y[i])) {
                split = split || !first;
                continue;
            }
            first = first ? first : i;
            last = i;
            least = !least || y[i] < y[*least] ? i : *least;
            greatest = !greatest || y[i] > y[*greatest] ? i : *greatest;
        }
        if (split && !line.empty() && std::isfinite(line.back().y)) {
            line.push_back({x[group.begin], std::numeric_limits<double>::quiet_NaN()});
        }
        if (first) {
            add(*first);
            add(std::min(*least, *greatest));
            add(std::max(*least, *greatest));
            add(*last);
        }
    }
    return line;
}

std::vector<BandPoint> band_of(std::span<const double> x, std::span<const double> low, std::span<const double> high,
                               std::span<const Group> groups) {
    std::vector<BandPoint> band;
    for (const Group group : groups) {
        const auto of_group = [&](std::span<const double> numbers) {
            return range_of(numbers.subspan(group.begin, group.end - group.begin));
        };
        if (const auto lows = of_group(low), highs = of_group(high); lows && highs) {
            band.push_back({x[group.begin], lows->min, highs->max});
        }
    }
    return band;
}

std::vector<double> running_mean(std::span<const double> y, std::size_t window) {
    std::vector<double> means;
    means.reserve(y.size());
    for (std::size_t i = 0; i < y.size(); ++i) {
        const std::size_t begin = i + 1 > window ? i + 1 - window : 0;
        means.push_back(std::isfinite(y[i]) ? mean_of(y, {begin, i + 1}) : std::numeric_limits<double>::quiet_NaN());
    }
    return means;
}

double mean_of(std::span<const double> y, Group group) {
    double sum = 0, count = 0;
    for (std::size_t i = group.begin; i < group.end; ++i) {
        if (std::isfinite(y[i])) {
            sum += y[i];
            ++count;
        }
    }
    return count > 0 ? sum / count : 0;
}

std::optional<std::size_t> nearest(std::span<const double> x, double at) {
    if (x.empty()) {
        return std::nullopt;
    }
    const auto after = static_cast<std::size_t>(std::lower_bound(x.begin(), x.end(), at) - x.begin());
    if (after == 0 || (after < x.size() && x[after] - at < at - x[after - 1])) {
        return after;
    }
    return after - 1;
}

std::vector<double> histogram(std::span<const float> numbers, Range range, std::size_t count) {
    std::vector<double> bins(count);
    for (const float number : numbers) {
        if (range.contains(number)) {
            const double place = range.width() > 0 ? (number - range.min) / range.width() : 0;
            ++bins[std::min(static_cast<std::size_t>(place * static_cast<double>(count)), count - 1)];
        }
    }
    return bins;
}

// ---- marks and notes -------------------------------------------------------------------------------------------

std::vector<Group> mark_groups(std::span<const Mark> marks, Range shown, double distance) {
    std::vector<Group> groups;
    for (std::size_t i = 0; i < marks.size(); ++i) {
        if (!shown.contains(marks[i].x)) {
            continue;
        }
        if (groups.empty() || marks[i].x - marks[groups.back().begin].x >= distance) {
            groups.push_back({i, i});
        }
        groups.back().end = i + 1;
    }
    return groups;
}

Corner note_place(Box plot, Corner size, float y, Corner window) {
    constexpr float gap = 4;
    const float beside = std::clamp(y - size.y / 2, 0.0f, std::max(window.y - size.y, 0.0f));
    if (plot.left - gap >= size.x) {
        return {plot.left - gap - size.x, beside};
    }
    if (window.x - plot.right - gap >= size.x) {
        return {plot.right + gap, beside};
    }
    const float along = std::clamp(plot.left, 0.0f, std::max(window.x - size.x, 0.0f));
    if (plot.top - gap >= size.y) {
        return {along, plot.top - gap - size.y};
    }
    return {along, std::max(std::min(plot.bottom + gap, window.y - size.y), 0.0f)};
}

} // namespace evod::viewer
