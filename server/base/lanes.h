// Lanes: the compiler's vector types, EVOD_LANES numbers wide, for kernels. A kernel is a file that is compiled once
// for each set of instructions: for every processor, for AVX2 and for AVX-512.
//
// Everything in this file is in an unnamed namespace, and kernels include no other inline code. If the copies of a
// kernel shared an inline function, the linker would keep only one copy of that function. The copy might contain
// instructions that some processors lack.
// Determinism  a lane computes what a loop over single numbers would compute, so results do not depend on the width.
//              Kernels use only + − × ÷ √, rounding and integer operations.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#if defined(__x86_64__)
#include <immintrin.h> // always inlined; for operations that have no operator
#endif

/// EVOD_KERNEL(name) is the name of a kernel in this copy.
#if EVOD_LANES == 16
#define EVOD_KERNEL(name) name##_avx512
#elif EVOD_LANES == 8
#define EVOD_KERNEL(name) name##_avx2
#else
#define EVOD_KERNEL(name) name##_baseline
#endif

namespace evod::base {
namespace {

constexpr std::size_t lanes = EVOD_LANES;
static_assert(lanes == 4 || lanes == 8 || lanes == 16);

using Floats = float __attribute__((vector_size(4 * lanes)));
using Integers = std::int32_t __attribute__((vector_size(4 * lanes)));
using Words = std::uint32_t __attribute__((vector_size(4 * lanes)));
using Longs = std::uint64_t __attribute__((vector_size(4 * lanes))); // half as many lanes, each twice as wide

template <class Vector, class T>
inline Vector load(const T* from) {
    static_assert(sizeof(T) == 4);
    Vector vector;
    __builtin_memcpy(&vector, from, sizeof vector);
    return vector;
}

template <class Vector, class T>
inline void store(T* to, Vector vector) {
    static_assert(sizeof(T) == 4);
    __builtin_memcpy(to, &vector, sizeof vector);
}

/// Prefetches elements of the columns some distance after index i. The hardware prefetcher follows fewer columns at
/// once than kernels read. Without this function, a tick of 1,000,000 organisms takes a sixth longer.
template <class... Columns>
inline void prefetch_ahead(std::size_t i, const Columns*... columns) {
    constexpr std::size_t ahead = 512, per_cache_line = 16, into_second_level = 2;
    if (i % per_cache_line == 0) {
        (__builtin_prefetch(columns + i + ahead, 0, into_second_level), ...);
    }
}

/// Returns a vector with the value in every lane.
inline Floats all_lanes(float value) {
    return value - Floats{};
}
inline Integers all_lanes(std::int32_t value) {
    return value - Integers{};
}
inline Words all_lanes(std::uint32_t value) {
    return value - Words{};
}

inline Floats lesser(Floats a, Floats b) {
    return b < a ? b : a;
}
inline Floats greater(Floats a, Floats b) {
    return a < b ? b : a;
}

inline Floats to_floats(Integers v) {
    return __builtin_convertvector(v, Floats);
}

inline Floats square_root(Floats v) {
#if defined(__x86_64__) && EVOD_LANES == 16
    return (Floats)_mm512_maskz_sqrt_ps(0xffff, (__m512)v);
#elif defined(__x86_64__) && EVOD_LANES == 8
    return (Floats)_mm256_sqrt_ps((__m256)v);
#elif defined(__x86_64__)
    return (Floats)_mm_sqrt_ps((__m128)v);
#else
    for (std::size_t i = 0; i < lanes; ++i) {
        v[i] = __builtin_sqrtf(v[i]);
    }
    return v;
#endif
}

/// Rounds to the nearest integer, halves to even.
inline Integers round_to_integers(Floats v) {
#if defined(__x86_64__) && EVOD_LANES == 16
    return (Integers)_mm512_maskz_cvtps_epi32(0xffff, (__m512)v);
#elif defined(__x86_64__) && EVOD_LANES == 8
    return (Integers)_mm256_cvtps_epi32((__m256)v);
#elif defined(__x86_64__)
    return (Integers)_mm_cvtps_epi32((__m128)v);
#else
    Integers rounded{};
    for (std::size_t i = 0; i < lanes; ++i) {
        rounded[i] = static_cast<std::int32_t>(__builtin_lrintf(v[i]));
    }
    return rounded;
#endif
}

/// Returns a number whose bit i is 1 if the comparison holds in lane i.
inline unsigned bits_of(Integers mask) {
#if defined(__x86_64__) && EVOD_LANES == 16
    return static_cast<unsigned>(_mm512_movepi32_mask((__m512i)mask));
#elif defined(__x86_64__) && EVOD_LANES == 8
    return static_cast<unsigned>(_mm256_movemask_ps((__m256)mask));
#elif defined(__x86_64__)
    return static_cast<unsigned>(_mm_movemask_ps((__m128)mask));
#else
    unsigned bits = 0;
    for (std::size_t i = 0; i < lanes; ++i) {
        bits |= (mask[i] != 0 ? 1u : 0u) << i;
    }
    return bits;
#endif
}

/// Multiplies the lower halves of the 64-bit lanes; the products have 64 bits.
inline Longs multiply_low_halves(Longs a, Longs b) {
#if defined(__x86_64__) && EVOD_LANES == 16
    return (Longs)_mm512_maskz_mul_epu32(0xff, (__m512i)a, (__m512i)b);
#elif defined(__x86_64__) && EVOD_LANES == 8
    return (Longs)_mm256_mul_epu32((__m256i)a, (__m256i)b);
#elif defined(__x86_64__)
    return (Longs)_mm_mul_epu32((__m128i)a, (__m128i)b);
#else
    return (a & 0xffff'ffffu) * (b & 0xffff'ffffu);
#endif
}

/// Moves the even 32-bit lanes to the lower halves of 64-bit lanes; odd_lanes() does so with the odd lanes. The upper
/// halves of the results are undefined.
inline Longs even_lanes(Words v) {
    return (Longs)v;
}
inline Longs odd_lanes(Words v) {
    return (Longs)v >> 32;
}
/// The inverse of even_lanes() and odd_lanes(): moves the lower halves to the even and the odd 32-bit lanes.
inline Words interleave(Longs even, Longs odd) {
    return (Words)((even & 0xffff'ffffu) | odd << 32);
}

/// Returns a vector whose lane i is lane from(i) of a, or lane from(i) − lanes of b.
template <class From, std::size_t... i>
inline Words shuffled(Words a, Words b, From from, std::index_sequence<i...>) {
    return __builtin_shufflevector(a, b, from(i)...);
}
template <class From>
inline Words shuffled(Words a, Words b, From from) {
    return shuffled(a, b, from, std::make_index_sequence<lanes>{});
}

/// Combines lane 2i of a and lane 2i of b into one 64-bit lane, with a's lane in the lower half. odd_pairs() does the
/// same with lanes 2i + 1.
inline Longs even_pairs(Words a, Words b) {
    return (Longs)shuffled(a, b, [](std::size_t i) { return i % 2 == 0 ? i : i + lanes - 1; });
}
inline Longs odd_pairs(Words a, Words b) {
    return (Longs)shuffled(a, b, [](std::size_t i) { return i % 2 == 0 ? i + 1 : i + lanes; });
}

/// Exchanges the two halves of each 64-bit lane: a rotation by 32 bits.
inline Longs exchanged_halves(Longs v) {
    return (Longs)shuffled((Words)v, (Words)v, [](std::size_t i) { return i ^ 1; });
}

} // namespace
} // namespace evod::base
