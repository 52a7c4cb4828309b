#include "client/viewer/text/numbers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace evod::viewer {
namespace {

TEST(Print, HasNoLengthLimit) {
    EXPECT_EQ(print("%d of %s", 3, "four"), "3 of four");
    EXPECT_EQ(print("%500d", 7).size(), 500);
    EXPECT_EQ(print("%s", ""), "");
}

TEST(Numbers, HaveSeparators) {
    EXPECT_EQ(with_separators(0), "0");
    EXPECT_EQ(with_separators(999), "999");
    EXPECT_EQ(with_separators(1000), "1,000");
    EXPECT_EQ(with_separators(1234567), "1,234,567");
    EXPECT_EQ(with_separators("-1234.5678"), "−1,234.5678");
    EXPECT_EQ(with_separators("1e+20"), "1e+20");
}

TEST(Numbers, HaveSixDigits) {
    EXPECT_EQ(shown_number(1234.5), "1,234.5");
    EXPECT_EQ(shown_number(0.0123), "0.0123");
    EXPECT_EQ(shown_number(-7), "−7");
    EXPECT_EQ(shown_number(1'000'000), "1,000,000");
    EXPECT_EQ(shown_number(-1e-9), "−1e-09");
    EXPECT_EQ(three_digits(1.20817), "1.21");
    EXPECT_EQ(three_digits(348.59), "349");
    EXPECT_EQ(three_digits(999.7), "1,000");
    EXPECT_EQ(three_digits(12'345.6), "12,346");
    EXPECT_EQ(three_digits(-0.01234), "−0.0123");
    EXPECT_EQ(three_digits(1.0 / 0.0), "–");
    EXPECT_EQ(shown_number(0), "0");
    EXPECT_EQ(shown_number(std::numeric_limits<double>::quiet_NaN()), "–");
}

TEST(Numbers, OfAFitnessHaveSeparators) { // the digits: tests/unit/text
    EXPECT_EQ(shown_fitness(-1234.56), "−1,234.6");
    EXPECT_EQ(shown_fitness(0.95312), "0.9531");
    EXPECT_EQ(shown_fitness(-0.0), "0.0");
    EXPECT_EQ(shown_fitness(std::numeric_limits<double>::infinity()), "–");
}

TEST(Numbers, AreReadOnlyFromDigits) {
    EXPECT_EQ(whole_number("0"), 0u);
    EXPECT_EQ(whole_number("18446744073709551615"), ~std::uint64_t{0});
    for (const char* text : {"", "-1", "+1", "1.5", "7 ", " 7", "1,000", "18446744073709551616", "seven"}) {
        EXPECT_EQ(whole_number(text), std::nullopt) << text;
    }
}

TEST(Numbers, OfAFieldAreCheckedAgainstTheirRange) {
    std::string problem = "seed: earlier";
    EXPECT_EQ(number_in("ticks", "60", 1, 1000, problem), 60u);
    EXPECT_EQ(problem, "");
    for (const char* refused : {"0", "1001", "-3", "", "6 0", "99999999999999999999"}) {
        EXPECT_EQ(number_in("ticks", refused, 1, 1000, problem), std::nullopt) << refused;
        EXPECT_EQ(problem, "ticks: got \"" + std::string{refused} + "\", allowed whole numbers from 1 to 1,000");
    }
}

TEST(NiceSteps, AreOneTwoOrFiveTimesAPowerOfTen) {
    EXPECT_EQ(nice_step(0), 1);
    EXPECT_EQ(nice_step(1), 1);
    EXPECT_EQ(nice_step(1.01), 2);
    EXPECT_EQ(nice_step(3), 5);
    EXPECT_EQ(nice_step(5.1), 10);
    EXPECT_EQ(nice_step(1000), 1000);
    EXPECT_NEAR(nice_step(0.03), 0.05, 1e-12);
}

TEST(NiceSteps, FollowEachOther) {
    for (const double power : {1e-9, 1.0, 1e15, 1e18}) {
        EXPECT_DOUBLE_EQ(nice_step(1.5 * power), 2 * power);
        EXPECT_DOUBLE_EQ(nice_step(1.5 * 2 * power), 5 * power);
        EXPECT_DOUBLE_EQ(nice_step(1.5 * 5 * power), 10 * power);
    }
}

} // namespace
} // namespace evod::viewer
