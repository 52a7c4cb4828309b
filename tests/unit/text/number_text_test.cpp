#include "proto/text/number_text.h"

#include <boost/json.hpp>
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>

namespace evod::text {
namespace {

using Limits = std::numeric_limits<double>;

constexpr double numbers[] = {0,
                              -0.0,
                              0.1,
                              -2.5,
                              1.0 / 3,
                              100'000,
                              123456.789,
                              1e-5,
                              9.9e-6,
                              2.345,
                              0.5,
                              1.5,
                              0.15,
                              1e15,
                              1e20,
                              1e300,
                              -1e-300,
                              Limits::max(),
                              Limits::lowest(),
                              Limits::min(),
                              Limits::denorm_min()};

std::string printed(const char* format, int digits, double number) {
    char line[500];
    std::snprintf(line, sizeof line, format, digits, number);
    return line;
}

TEST(NumberText, IsTheShortestThatParsesBackTheSame) {
    EXPECT_EQ(number_text(0.1), "0.1");
    EXPECT_EQ(number_text(0), "0");
    EXPECT_EQ(number_text(-2.5), "-2.5");
    EXPECT_EQ(number_text(10'000), "10000");
    EXPECT_EQ(number_text(100'000), "1e+05");
    EXPECT_EQ(number_text(1e-4), "1e-04");
    EXPECT_EQ(number_text(1e20), "1e+20");
    for (const Exponent exponent : {Exponent::IfShorter, Exponent::IfLong, Exponent::Never}) {
        for (const double number : numbers) {
            EXPECT_EQ(std::strtod(number_text(number, exponent).c_str(), nullptr), number);
        }
    }
}

TEST(NumberText, NamesWhatIsNoFiniteNumber) {
    for (const Exponent exponent : {Exponent::IfShorter, Exponent::IfLong, Exponent::Never}) {
        EXPECT_EQ(number_text(Limits::quiet_NaN(), exponent), "nan");
        EXPECT_EQ(number_text(-Limits::infinity(), exponent), "-inf");
    }
}

TEST(NumberText, HasAnExponentOnlyIfLong) {
    const auto text_of = [](double number) { return number_text(number, Exponent::IfLong); };
    EXPECT_EQ(text_of(0), "0");
    EXPECT_EQ(text_of(0.15), "0.15");
    EXPECT_EQ(text_of(500'000), "500000");
    EXPECT_EQ(text_of(1e-5), "0.00001");
    EXPECT_EQ(text_of(9.5e-6), "9.5e-06");
    EXPECT_EQ(text_of(1e14), "100000000000000");
    EXPECT_EQ(text_of(-1e15), "-1e+15");
    EXPECT_EQ(text_of(-1e300), "-1e+300");
}

TEST(NumberText, NeverHasAnExponentIfNotAllowed) {
    EXPECT_EQ(number_text(1e20, Exponent::Never), "100000000000000000000");
    for (const double number : numbers) {
        EXPECT_EQ(number_text(number, Exponent::Never).find('e'), std::string::npos) << number;
    }
    EXPECT_EQ(number_text(-Limits::denorm_min(), Exponent::Never).size(), 327u) << "a text of the greatest length";
}

TEST(NumberText, IsRoundedLikePrintf) {
    EXPECT_EQ(rounded(1.0 / 3, 10), "0.3333333333");
    EXPECT_EQ(rounded(100'000, 10), "100000");
    EXPECT_EQ(rounded(2.50, 10), "2.5");
    EXPECT_EQ(fixed(2.345, 1), "2.3");
    EXPECT_EQ(fixed(0.5, 0), "0");
    EXPECT_EQ(fixed(1.5, 0), "2");
    for (const double number : numbers) {
        EXPECT_EQ(rounded(number, 10), printed("%.*g", 10, number));
        for (const int decimals : {0, 1, 3, 80}) {
            EXPECT_EQ(fixed(number, decimals), printed("%.*f", decimals, number));
        }
    }
    EXPECT_EQ(fixed(Limits::quiet_NaN(), 1), "nan");
    EXPECT_EQ(fixed(-Limits::infinity(), 1), "-inf");
}

TEST(NumberText, OfAFitnessIsTheSameInAllPrograms) {
    std::ifstream file{EVOD_SOURCE_FOLDER "/proto/vectors/fitness.json"};
    const std::string vectors(std::istreambuf_iterator<char>{file}, {});
    const boost::json::value examples = boost::json::parse(vectors); // outlives the loop
    for (const boost::json::value& vector : examples.as_array()) {
        EXPECT_EQ(fitness_text(vector.at(0).to_number<double>()), vector.at(1).as_string()) << vector;
    }
    EXPECT_EQ(fitness_text(Limits::quiet_NaN()), "nan");
    EXPECT_EQ(fitness_text(-Limits::infinity()), "-inf");
}

} // namespace
} // namespace evod::text
