// Draws for several entities at once, for kernels (lanes.h). Each lane gives the same result as the corresponding
// function in random.h or elementary.h.
#pragma once

#include "server/base/lanes.h"

namespace evod::base {
namespace {

struct WordPairs {
    Words first, second;
};

/// Computes RandomKey::pair(entity, tick) with Philox2x32-10. counter is pair_counter(tick), and key is pair_key().
inline WordPairs philox_pairs(Words entity, std::uint32_t counter, std::uint32_t key) {
    struct Counter {
        Longs first, second;
    };
    // Even and odd lanes are processed separately, each in the lower half of a 64-bit lane. The upper halves are
    // undefined.
    Counter even{even_lanes(entity), Longs{} + counter}, odd{odd_lanes(entity), Longs{} + counter};
    const Longs multiplier = Longs{} + 0xd256d193u;
    const auto round = [&](Counter& words, std::uint32_t round_key) {
        const Longs product = multiply_low_halves(words.first, multiplier);
        words = {product >> 32 ^ words.second ^ (Longs{} + round_key), product};
    };
    for (int i = 0; i < 10; ++i, key += 0x9e3779b9u) {
        round(even, key);
        round(odd, key);
    }
    return {interleave(even.first, odd.first), interleave(even.second, odd.second)};
}

/// Computes unit_float() for each word.
inline Floats unit_floats(Words words) {
    return to_floats((Integers)(words >> 8)) * 0x1p-24f;
}

struct Directions {
    Floats x, y;
};

/// Computes direction() for each word.
inline Directions directions(Words words) {
    const Words quarter = (words + 0x2000'0000u) >> 30;
    const Floats angle =
        to_floats((Integers)(words - (quarter << 30))) * static_cast<float>(2 * 3.14159265358979323846 / 4294967296.0);
    const Floats square = angle * angle;
    // The coefficients are 1/n!, as in direction().
    Floats sine = all_lanes(static_cast<float>(1.0 / 362880));
    sine = sine * square - static_cast<float>(1.0 / 5040);
    sine = sine * square + static_cast<float>(1.0 / 120);
    sine = sine * square - static_cast<float>(1.0 / 6);
    sine = (sine * square + 1.0f) * angle;
    Floats cosine = all_lanes(static_cast<float>(1.0 / 40320));
    cosine = cosine * square - static_cast<float>(1.0 / 720);
    cosine = cosine * square + static_cast<float>(1.0 / 24);
    cosine = cosine * square - 0.5f;
    cosine = cosine * square + 1.0f;
    const Integers swapped = (quarter & 1u) != 0u;
    // x is negative in the quarters 1 and 2, y in the quarters 2 and 3.
    const Words sign_x = ((quarter + 1u) & 2u) << 30, sign_y = (quarter & 2u) << 30;
    const Floats x = swapped ? sine : cosine, y = swapped ? cosine : sine;
    return {(Floats)((Words)x ^ sign_x), (Floats)((Words)y ^ sign_y)};
}

} // namespace
} // namespace evod::base
