// Items kernels: the nearest items, eight places at a time.
//
// Determinism  compiled for two sets of instructions, with the same bits (base/instructions.h).
#pragma once

#include <cstddef>
#include <cstdint>

namespace evod::simulation {

constexpr std::uint32_t no_item = ~0u;

/// Places of up to eight items that lie in one cell; one cache line. Empty slots, which come last, lie elsewhere
/// (physics/bodies.h), so that all eight can be looked at at once.
struct alignas(64) ItemBucket {
    static constexpr std::uint32_t slots = 8;
    std::int32_t x[slots], y[slots];
};

/// A uniform grid of buckets, row by row: bucket c is that of cell c; then come those that took what did not fit.
struct ItemGrid {
    const ItemBucket* buckets;                       // the one at [-1] is empty
    const std::uint32_t (*items)[ItemBucket::slots]; // per bucket
    const std::uint32_t* next;                       // per bucket: the next of the same cell, or no_item
    std::uint32_t rows, columns;
    std::int64_t side;   // of a cell, units
    std::uint64_t scale; // cells per unit, times 2^scale_bits
    static constexpr unsigned scale_bits = 44;
};

struct TwoNearest {
    std::uint32_t place; // bucket and slot of the nearest, times ItemBucket::slots; of equally near ones, that of the
                         // lowest id; no_item if there is none
    std::int32_t x, y;   // where it lies; elsewhere if there is none
    float square;        // of its distance, px²; radius² if there is none
    float others_square; // no other item is nearer than this, px²; at most radius²
};

/// Of the items at most `radius` px from (x, y), a distance equal to the radius included.
struct ItemQuery {
    std::int32_t x, y;
    float radius;
};

struct ItemsKernels {
    /// Asks for the memory that two_nearest() will need.
    void (*prefetch)(const ItemGrid& grid, const ItemQuery* queries, std::size_t count);
    /// Answers queries. The cost of one grows with the number of cells that have to be looked at until both nearest are
    /// known, whatever the radius.
    void (*two_nearest)(const ItemGrid& grid, const ItemQuery* queries, TwoNearest* answers, std::size_t count);
};

/// Those for the instructions in use.
const ItemsKernels& items_kernels();

} // namespace evod::simulation
