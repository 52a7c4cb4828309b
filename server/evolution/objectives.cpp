#include "server/evolution/objectives.h"

#include "server/base/assert.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace evod::evolution {
namespace {

bool dominates(std::span<const double> one, std::span<const double> other) {
    bool is_better = false;
    for (std::size_t i = 0; i < one.size(); ++i) {
        if (one[i] < other[i]) {
            return false;
        }
        is_better |= one[i] > other[i];
    }
    return is_better;
}

} // namespace

std::vector<std::vector<std::uint32_t>> fronts(const Objectives& objectives) {
    EVOD_ASSERT(objectives.count >= 1);
    std::vector<std::uint32_t> order(objectives.organisms());
    std::iota(order.begin(), order.end(), 0u);
    // In this order, no organism is dominated by a later one.
    std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) {
        const auto numbers = objectives.of(a), others = objectives.of(b);
        const auto [mine, theirs] = std::ranges::mismatch(numbers, others);
        return mine == numbers.end() ? a < b : *mine > *theirs;
    });
    std::vector<std::vector<std::uint32_t>> fronts;
    for (const std::uint32_t organism : order) {
        const auto has_dominator = [&](const std::vector<std::uint32_t>& front) {
            // Of two objectives, the last organism of a front has the largest second one.
            const std::size_t compared = objectives.count <= 2 ? 1 : front.size();
            return std::any_of(
                front.rbegin(), front.rbegin() + static_cast<std::ptrdiff_t>(compared),
                [&](std::uint32_t other) { return dominates(objectives.of(other), objectives.of(organism)); });
        };
        // An organism that is dominated from a front is dominated from all fronts before it, too.
        const auto front = std::ranges::partition_point(fronts, has_dominator);
        if (front == fronts.end()) {
            fronts.push_back({organism});
        } else {
            front->push_back(organism);
        }
    }
    return fronts;
}

std::vector<double> crowding_distances(const Objectives& objectives, std::span<const std::uint32_t> front) {
    std::vector<double> distances(front.size());
    std::vector<std::size_t> order(front.size()); // places in `front`
    std::iota(order.begin(), order.end(), std::size_t{0});
    for (std::size_t objective = 0; objective < objectives.count && !front.empty(); ++objective) {
        const auto number = [&](std::size_t place) { return objectives.of(front[place])[objective]; };
        std::ranges::sort(order, [&](std::size_t a, std::size_t b) {
            return number(a) < number(b) || (number(a) == number(b) && front[a] < front[b]);
        });
        distances[order.front()] = distances[order.back()] = std::numeric_limits<double>::infinity();
        const double width = number(order.back()) - number(order.front());
        for (std::size_t i = 1; i + 1 < order.size() && width > 0; ++i) {
            distances[order[i]] += (number(order[i + 1]) - number(order[i - 1])) / width;
        }
    }
    return distances;
}

std::vector<double> standing(const Objectives& objectives) {
    std::vector<double> standing(objectives.organisms());
    double better = 0;
    for (const std::vector<std::uint32_t>& front : fronts(objectives)) {
        const std::vector<double> distances = crowding_distances(objectives, front);
        std::vector<std::size_t> order(front.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::ranges::stable_sort(order, std::ranges::greater{}, [&](std::size_t place) { return distances[place]; });
        for (std::size_t i = 0; i < order.size(); ++i) {
            const bool is_equal = i > 0 && distances[order[i]] == distances[order[i - 1]];
            standing[front[order[i]]] = is_equal ? standing[front[order[i - 1]]] : -(better + static_cast<double>(i));
        }
        better += static_cast<double>(front.size());
    }
    return standing;
}

} // namespace evod::evolution
