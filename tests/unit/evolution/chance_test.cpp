#include "server/evolution/chance.h"

#include "tests/unit/evolution/draws.h"

#include <gtest/gtest.h>

namespace evod::evolution {
namespace {

TEST(Chance, BitsAreIndependent) {
    // Law: p^k (1−p)^(3−k) for a pattern of k ones. Chi-square over 8 patterns, 7 degrees of freedom.
    for (const double p : {0.15, 0.5, 0.9, 1.0 / 3}) {
        const Chance chance{p};
        base::RandomStream random = stream_of(101);
        std::vector<std::uint64_t> counts(8);
        for (int i = 0; i < 400'000; ++i) {
            ++counts.at(chance.draw_bits(3, random));
        }
        std::vector<double> law(8);
        for (unsigned pattern = 0; pattern < 8; ++pattern) {
            law[pattern] = 1;
            for (unsigned bit = 0; bit < 3; ++bit) {
                law[pattern] *= (pattern >> bit & 1) != 0 ? p : 1 - p;
            }
        }
        EXPECT_GT(p_value_of_law(counts, law), alpha) << p;
    }
}

TEST(Chance, SmallProbabilitiesAreKept) {
    // Law: 6 · 10^6 events of probability 10^-4. Chi-square, 1 degree of freedom.
    const Chance chance{1e-4};
    base::RandomStream random = stream_of(102);
    std::vector<std::uint64_t> counts(2);
    for (int i = 0; i < 1'000'000; ++i) {
        const std::uint32_t bits = chance.draw_bits(6, random);
        for (unsigned bit = 0; bit < 6; ++bit) {
            ++counts[bits >> bit & 1];
        }
    }
    EXPECT_GT(p_value_of_law(counts, std::vector{1 - 1e-4, 1e-4}), alpha);
}

TEST(Chance, ZeroAndOneDrawNoWord) {
    base::RandomStream random = stream_of(103), untouched = stream_of(103);
    EXPECT_EQ(Chance{0}.draw_bits(32, random), 0u);
    EXPECT_EQ(Chance{1}.draw_bits(32, random), 0xffffffffu);
    EXPECT_TRUE(Chance{1}.draw(random));
    EXPECT_TRUE(Chance{0}.is_never());
    EXPECT_FALSE(Chance{1}.is_never());
    EXPECT_EQ(random.word(), untouched.word());
}

TEST(Chance, AllWidthsFollowTheLaw) {
    // Law: `width` independent bits of probability 0.3. Chi-square, 1 degree of freedom for each width.
    const Chance chance{0.3};
    for (const unsigned width : {1u, 2u, 7u, 16u, 17u, 24u, 32u}) {
        base::RandomStream random = stream_of(104, width);
        std::vector<std::uint64_t> counts(2);
        for (int i = 0; i < 20'000; ++i) {
            const std::uint64_t bits = chance.draw_bits(width, random);
            ASSERT_EQ(bits >> width, 0u);
            for (unsigned bit = 0; bit < width; ++bit) {
                ++counts[bits >> bit & 1];
            }
        }
        EXPECT_GT(p_value_of_law(counts, std::vector{0.7, 0.3}), alpha) << width;
    }
}

} // namespace
} // namespace evod::evolution
