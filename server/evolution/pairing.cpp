#include "server/evolution/pairing.h"

#include "server/base/assert.h"
#include "server/evolution/shuffle.h"

namespace evod::evolution {

std::vector<Parents> pair_up(std::span<const std::uint32_t> parents, std::uint32_t pair_count,
                             const base::RandomKey& key, base::Executor& executor) {
    std::vector<Parents> pairs;
    pairs.reserve(pair_count);
    EVOD_ASSERT(pair_count == 0 || !parents.empty());
    const std::size_t count = parents.size();
    std::vector<std::uint32_t> order(count);
    for (std::uint32_t round = 0; pairs.size() < pair_count; ++round) {
        base::RandomStream random{key, round};
        order.assign(parents.begin(), parents.end());
        shuffle(order, random, executor);
        for (std::size_t i = 0; i + 1 < count && pairs.size() < pair_count; i += 2) {
            pairs.push_back({order[i], order[i + 1]});
        }
        if (count % 2 == 1 && pairs.size() < pair_count) {
            // The last parent mates with the first of the shuffled order, which is a random other parent. A single
            // parent mates with itself.
            pairs.push_back({order[count - 1], order[0]});
        }
    }
    return pairs;
}

} // namespace evod::evolution
