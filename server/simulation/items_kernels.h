// Items kernels: find the nearest items, eight positions at a time.
//
// Determinism  the kernels are compiled for baseline instructions and AVX2, which give the same bits
//              (base/instructions.h).
#pragma once

#include <cstddef>
#include <cstdint>

namespace evod::simulation {

constexpr std::uint32_t no_item = ~0u;

/// The positions of up to eight items of one cell, in one cache line. Empty slots come last and have void_position
/// (physics/units.h), so that all eight can be tested at once.
struct alignas(64) ItemBucket {
    static constexpr std::uint32_t slots = 8;
    std::int32_t x[slots], y[slots];
};

/// A uniform grid of buckets, row by row: bucket c is the first bucket of cell c. Overflow buckets follow.
struct ItemGrid {
    const ItemBucket* buckets;                       // buckets[-1] is an empty bucket
    const std::uint32_t (*items)[ItemBucket::slots]; // per bucket
    const std::uint32_t* next;                       // per bucket: the next bucket of the same cell, or no_item
    std::uint32_t rows, columns;
    std::int64_t side;   // side of a cell, units
    std::uint64_t scale; // cells per unit, times 2^scale_bits
    static constexpr unsigned scale_bits = 44;
};

struct TwoNearest {
    // The bucket of the nearest item, times ItemBucket::slots, plus its slot; no_item if there is none. Of equally near
    // items, the one with the lowest id.
    std::uint32_t place;
    std::int32_t x, y;   // its position; void_position if there is none
    float square;        // its squared distance, px²; radius² if there is none
    float others_square; // lower bound on the squared distance of all other items, px²; at most radius²
};

/// An item that disappeared or reappeared.
struct ItemChange {
    std::int32_t x, y;
    bool came; // true: it reappeared; false: it disappeared
};

/// A search for items at most `radius` px from (x, y); a distance equal to the radius is included.
struct ItemQuery {
    std::int32_t x, y;
    float radius;
};

struct ItemsKernels {
    /// Prefetches the memory that two_nearest() reads.
    void (*prefetch)(const ItemGrid& grid, const ItemQuery* queries, std::size_t count);
    /// Answers queries. The cost depends only on the number of cells that must be searched to find the two nearest
    /// items, not on the radius.
    void (*two_nearest)(const ItemGrid& grid, const ItemQuery* queries, TwoNearest* answers, std::size_t count);
};

/// Returns the kernels for the instruction set in use (base/instructions.h).
const ItemsKernels& items_kernels();

} // namespace evod::simulation
