#include "server/base/exact_number.h"

#include <gtest/gtest.h>

#include <limits>

namespace evod::base {
namespace {

TEST(ExactNumber, PortableSeedsSurviveADouble) {
    for (const std::uint64_t word : {std::uint64_t{0}, std::uint64_t{7}, exact_number_end, ~std::uint64_t{0}}) {
        const Seed seed = portable_seed(word);
        EXPECT_TRUE(is_portable(seed));
        EXPECT_EQ(static_cast<std::uint64_t>(static_cast<double>(seed.value)), seed.value);
    }
    EXPECT_EQ(portable_seed(7), Seed{7});
    EXPECT_FALSE(is_portable({15'122'833'770'251'422'136u}));
    EXPECT_FALSE(is_portable({exact_number_end}));
}

TEST(ExactNumber, WholeNumbersAreCounts) {
    EXPECT_EQ(whole_number_of(30.0), 30u);
    EXPECT_EQ(whole_number_of(0.0), 0u);
    EXPECT_EQ(whole_number_of(count_max), count_max);
    for (const double value : {0.5, -1.0, -0.0, 1e300, std::numeric_limits<double>::quiet_NaN()}) {
        EXPECT_EQ(whole_number_of(value), std::nullopt) << value;
    }
}

} // namespace
} // namespace evod::base
