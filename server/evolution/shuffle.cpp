#include "server/evolution/shuffle.h"

#include "server/evolution/distribution.h"

#include <vector>

namespace evod::evolution {
namespace {

constexpr std::size_t items_per_bucket = 16384; // average number
constexpr std::size_t items_per_stream = 16384;

} // namespace

void shuffle(std::span<std::uint32_t> items, base::RandomStream& random, base::Executor& executor) {
    if (items.size() <= shuffled_whole_max) {
        random.shuffle(items);
        return;
    }
    const base::RandomKey key{base::Seed{random.long_word()}, base::Purpose::Shuffle, 0, 0};
    const auto bucket_count = static_cast<std::uint32_t>(items.size() / items_per_bucket);
    std::vector<std::uint16_t> bucket_of(items.size()); // populations have far fewer than 2^16 buckets
    executor.parallel_for(items.size(), items_per_stream, [&](base::Range block) {
        base::RandomStream choices{key, static_cast<std::uint32_t>(block.begin / items_per_stream), 0};
        for (std::size_t i = block.begin; i < block.end; ++i) {
            bucket_of[i] = static_cast<std::uint16_t>(choices.below(bucket_count));
        }
    });
    const std::vector<std::uint32_t> present(items.begin(), items.end());
    const auto begins = distribute(
        items.size(), bucket_count, executor, [&](std::size_t i) { return bucket_of[i]; },
        [&](std::size_t i, std::uint32_t place) { items[place] = present[i]; });
    executor.parallel_for(bucket_count, 1, [&](base::Range buckets) {
        for (std::size_t bucket = buckets.begin; bucket < buckets.end; ++bucket) {
            base::RandomStream order{key, static_cast<std::uint32_t>(bucket), 1};
            order.shuffle(items.subspan(begins[bucket], begins[bucket + 1] - begins[bucket]));
        }
    });
}

} // namespace evod::evolution
