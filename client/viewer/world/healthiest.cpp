#include "client/viewer/world/healthiest.h"

#include <algorithm>
#include <numeric>

namespace evod::viewer {

std::vector<std::size_t> healthiest(const codec::Entities& organisms, std::size_t count) {
    std::vector<std::size_t> indices(organisms.id.size());
    std::iota(indices.begin(), indices.end(), std::size_t{0});
    count = std::min(count, indices.size());
    std::ranges::partial_sort(indices, indices.begin() + static_cast<std::ptrdiff_t>(count), [&](auto a, auto b) {
        const float of_a = organisms.health(a), of_b = organisms.health(b);
        return of_a != of_b ? of_a > of_b : organisms.id[a] < organisms.id[b];
    });
    indices.resize(count);
    return indices;
}

std::span<const std::size_t> HealthRanking::of(const std::shared_ptr<const codec::ReceivedSnapshot>& snapshot,
                                               std::size_t count) {
    if (snapshot != ranked_) {
        ranked_ = snapshot;
        indices_ = snapshot ? healthiest(snapshot->entities->organisms, ranked_count) : std::vector<std::size_t>{};
    }
    return std::span{indices_}.first(std::min(count, indices_.size()));
}

} // namespace evod::viewer
