#include "proto/codec/compression.h"

#include "tests/unit/codec/living_island.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <string>

namespace evod::codec {
namespace {

std::string noise(Random& random, std::size_t bytes, std::uint64_t kinds) {
    std::string made(bytes, '\0');
    std::ranges::generate(made, [&] { return static_cast<char>(below(random, kinds)); });
    return made;
}

RC_GTEST_PROP(Compression, TheContentIsRestoredForAllSeams, (std::uint64_t seed)) {
    Random random{seed};
    Compressor compressor;
    for (int round = 0; round < 5; ++round) {
        std::string bytes;
        Seams seams;
        for (std::uint64_t columns = below(random, 12); columns > 0; --columns) {
            seams.push_back(static_cast<std::uint32_t>(bytes.size()));
            bytes += noise(random, below(random, below(random, 8) == 0 ? 300'000 : 3000), 1 + below(random, 256));
        }
        const auto content = decompress(compressor.compress(bytes, seams), bytes.size());
        RC_ASSERT(content.has_value());
        RC_ASSERT(*content == bytes);
        RC_ASSERT(*decompress(compressor.compress(bytes), bytes.size()) == bytes);
    }
}

TEST(Compression, RegularBytesBesideRandomOnesGetShorter) {
    Random random{1};
    Compressor compressor;
    const std::string places = noise(random, 20'000, 256), small = noise(random, 20'000, 8);
    const auto seam = static_cast<std::uint32_t>(places.size());
    const std::size_t least = places.size() + small.size() * 3 / 8; // 3 bits each
    EXPECT_LT(compressor.compress(places + small, {0, seam}).size(), least + 200);
    EXPECT_GT(compressor.compress(places + small).size(), least + 2000);
}

TEST(Compression, ShortColumnsShareABlock) {
    Random random{2};
    Compressor compressor;
    std::string bytes;
    Seams seams;
    for (int column = 0; column < 30; ++column) {
        seams.push_back(static_cast<std::uint32_t>(bytes.size()));
        bytes += noise(random, 20, 4);
    }
    EXPECT_EQ(compressor.compress(bytes, seams), compressor.compress(bytes));
}

} // namespace
} // namespace evod::codec
