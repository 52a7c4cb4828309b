// Kernels compute in every lane what the functions for one entity compute. Tested with four lanes; the golden hashes,
// which hold for 4, 8 and 16 lanes, show that the other widths give the same.
#include "server/base/elementary.h"
#include "server/base/elementary_lanes.h"
#include "server/base/hash_lanes.h"
#include "server/base/random.h"
#include "server/base/random_lanes.h"
#include "server/base/state_hash.h"

#include <gtest/gtest.h>

#include <cmath>

namespace evod::base {
namespace {

Words some_words(RandomStream& random) {
    Words words{};
    for (std::size_t lane = 0; lane < lanes; ++lane) {
        words[lane] = random.word();
    }
    return words;
}

TEST(Lanes, DrawsEqualSingleDraws) {
    RandomStream random{RandomKey{Seed{1}, Purpose::ScenarioTest, 0, 0}, 0};
    for (int trial = 0; trial < 2000; ++trial) {
        const RandomKey key{Seed{random.long_word()}, Purpose::Behaviour, 3, 7};
        const std::uint32_t tick = random.word();
        const Words entity = some_words(random);
        const WordPairs pairs = philox_pairs(entity, key.pair_counter(tick), key.pair_key());
        const Floats floats = unit_floats(pairs.second);
        const Directions way = directions(pairs.first);
        for (std::size_t lane = 0; lane < lanes; ++lane) {
            const auto expected = key.pair(entity[lane], tick);
            ASSERT_EQ(pairs.first[lane], expected[0]);
            ASSERT_EQ(pairs.second[lane], expected[1]);
            ASSERT_EQ(floats[lane], unit_float(expected[1]));
            ASSERT_EQ(way.x[lane], direction(expected[0]).x);
            ASSERT_EQ(way.y[lane], direction(expected[0]).y);
        }
    }
}

TEST(Lanes, DirectionsNearQuarterTurnsEqualSingleOnes) {
    for (std::uint32_t eighth = 0; eighth < 8; ++eighth) {
        for (const std::int32_t step : {-1, 0, 1}) {
            const std::uint32_t word = (eighth << 29) + static_cast<std::uint32_t>(step);
            const Directions way = directions(all_lanes(word));
            EXPECT_EQ(way.x[0], direction(word).x) << word;
            EXPECT_EQ(way.y[3], direction(word).y) << word;
        }
    }
}

TEST(Lanes, ElementaryFunctionsEqualSingleOnes) {
    RandomStream random{RandomKey{Seed{3}, Purpose::ScenarioTest, 0, 0}, 0};
    for (int trial = 0; trial < 100'000; ++trial) {
        // Magnitudes from 2^-19 to 2^12, of both signs; sometimes 0.
        const auto some_floats = [&] {
            const Words words = some_words(random);
            const Floats size = unit_floats(words) * (Floats)(((words & 31u) + 108u) << 23);
            return (words & 32u) != 0u ? size : (words & 960u) == 0u ? Floats{} : -size;
        };
        const Floats x = some_floats(), y = some_floats();
        const Floats hyperbolic = tanh(x), angle = half_turns(x, y);
        const Directions way = directions_of(tanh(y) * 4.0f);
        for (std::size_t lane = 0; lane < lanes; ++lane) {
            ASSERT_EQ(hyperbolic[lane], base::tanh(x[lane])) << x[lane];
            ASSERT_EQ(angle[lane], base::half_turns(x[lane], y[lane])) << x[lane] << ", " << y[lane];
            const Direction expected = direction_of(base::tanh(y[lane]) * 4);
            ASSERT_EQ(way.x[lane], expected.x);
            ASSERT_EQ(way.y[lane], expected.y);
        }
    }
}

TEST(Lanes, HashSumsIncludeOnlyUsedLanes) {
    RandomStream random{RandomKey{Seed{2}, Purpose::ScenarioTest, 0, 0}, 0};
    HashSumsPerLane sums;
    StateHash expected;
    for (int trial = 0; trial < 500; ++trial) {
        const Words id = some_words(random), a = some_words(random), b = some_words(random), c = some_words(random),
                    d = some_words(random), e = some_words(random);
        const Integers used = (some_words(random) & 1u) != 0u;
        constexpr std::uint32_t kind = 9;
        sums.add(id + kind * 0x85ebca6bu, a, b, c, d, e, used);
        for (std::size_t lane = 0; lane < lanes; ++lane) {
            if (used[lane]) {
                expected += hash_of({kind, id[lane], a[lane], b[lane], c[lane], d[lane], e[lane]});
            }
        }
        ASSERT_EQ(sum_of(sums.low), expected.low);
        ASSERT_EQ(sum_of(sums.high), expected.high);
    }
}

TEST(Lanes, RoundHalvesToEvenAndRootsAreExact) {
    const Floats values{0.5f, 1.5f, -2.5f, 1234567.5f};
    const Integers rounded = round_to_integers(values);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
        EXPECT_EQ(rounded[lane], static_cast<std::int32_t>(std::lrint(values[lane])));
    }
    RandomStream random{RandomKey{Seed{3}, Purpose::ScenarioTest, 0, 0}, 0};
    for (int trial = 0; trial < 1000; ++trial) {
        const auto value = static_cast<float>(random.uniform(0, 1e6));
        EXPECT_EQ(square_root(all_lanes(value))[2], std::sqrt(value));
    }
}

} // namespace
} // namespace evod::base
