// Distribution: a stable counting sort of many items into buckets. Blocks of items are processed in parallel.
//
// Determinism  the place of an item depends on the buckets alone, not on the blocks.
#pragma once

#include "server/base/executor.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace evod::evolution {

/// Calls put(i, place) once for each i of 0 … count − 1, in parallel. Places are ordered by bucket, and within a bucket
/// by i.
///
/// bucket_of(i)  less than bucket_count; called twice.
/// returns       shape (bucket_count + 1): the place where each bucket begins, followed by `count`.
template <class BucketOf, class Put>
std::vector<std::uint32_t> distribute(std::size_t count, std::size_t bucket_count, base::Executor& executor,
                                      const BucketOf& bucket_of, const Put& put) {
    constexpr std::size_t block_size = 16384;
    const std::size_t blocks = (count + block_size - 1) / block_size;
    std::vector<std::uint32_t> places(blocks *
                                      bucket_count); // per block and bucket: number of items; later, next place
    executor.parallel_for(count, block_size, [&](base::Range block) {
        std::uint32_t* const counts = &places[block.begin / block_size * bucket_count];
        for (std::size_t i = block.begin; i < block.end; ++i) {
            ++counts[bucket_of(i)];
        }
    });
    std::vector<std::uint32_t> begins(bucket_count + 1);
    std::uint32_t next = 0;
    for (std::size_t bucket = 0; bucket < bucket_count; ++bucket) {
        begins[bucket] = next;
        for (std::size_t block = 0; block < blocks; ++block) {
            std::uint32_t& place = places[block * bucket_count + bucket];
            const std::uint32_t in_block = place;
            place = next;
            next += in_block;
        }
    }
    begins[bucket_count] = next;
    executor.parallel_for(count, block_size, [&](base::Range block) {
        std::uint32_t* const next_place = &places[block.begin / block_size * bucket_count];
        for (std::size_t i = block.begin; i < block.end; ++i) {
            put(i, next_place[bucket_of(i)]++);
        }
    });
    return begins;
}

} // namespace evod::evolution
