// Stateless randomness: every draw is a pure function of (seed, purpose, island, generation, entity, tick, draw).
//
// Determinism  there is no generator state to save, no order between streams, and no dependence on threads. A new draw
//              for one purpose does not change the draws of another.
// Source       Philox4x32-10, and Philox2x32-10 for pair(): Salmon, Moraes, Dror & Shaw 2011, "Parallel random numbers:
//              as easy as 1, 2, 3"; the implementation is Random123's.
#pragma once

#include "server/base/assert.h"

#include <array>
#include <cstdint>
#include <span>
#include <utility>

namespace evod::base {

/// The use of a stream. The numbers determine the draws of every run: never reuse or renumber one.
enum class Purpose : std::uint32_t {
    InitialChromosome = 1,
    OrganismPlacement = 2,
    FoodPlacement = 3,
    PoisonPlacement = 4,
    CratePlacement = 5,
    ObstaclePlacement = 6,
    Behaviour = 7,
    FoodRespawn = 8,
    PoisonRespawn = 9,
    Selection = 10,
    Pairing = 11,
    Crossover = 12,
    OrderMutation = 13,
    Mutation = 14,
    SurvivorMutation = 15,
    Migration = 16,
    Shuffle = 17,   // shuffles of many items; the seed itself is drawn, so island and generation are 0
    Replicate = 18, // seeds of the runs of a parameter sweep, keyed by replicate; island and generation are 0
    FitnessShuffle = 19,
    SignFlip = 20,       // signs in a permutation test; island and generation are 0
    LatinHypercube = 21, // cells of a parameter sweep, keyed by parameter; island and generation are 0
    Heading = 22,        // headings of organisms with a network at the beginning of a generation
    FirstFreeGenes = 23, // the Latin hypercube of the first generation, keyed by gene
    ClassMember = 24,    // seeds of the worlds of a class, keyed by the number of the member
    BirthPlacement = 25, // places of children around their parents, keyed by the first parent
    BirthParents = 26,   // parents of the genes of a child, with shuffle_births
    ScenarioTest = 1000, // tests and demonstrations
};

/// A run's seed; any 64-bit value.
struct Seed {
    std::uint64_t value = 0;
    friend bool operator==(const Seed&, const Seed&) = default;
};

/// The inputs of a draw that many entities share. Construct one RandomKey per (purpose, island, generation).
class RandomKey {
  public:
    RandomKey(Seed seed, Purpose purpose, std::uint32_t island, std::uint64_t generation);

    /// Returns four uniform 32-bit words.
    std::array<std::uint32_t, 4> words(std::uint32_t entity, std::uint64_t tick, std::uint32_t block) const;

    /// Returns two uniform 32-bit words from Philox2x32-10, in half the time of words(). Intended for draws made for
    /// every organism in every tick. The low half of this RandomKey is the Philox key; the high half is XORed with the
    /// tick. Do not call both pair() and words() for the same purpose.
    std::array<std::uint32_t, 2> pair(std::uint32_t entity, std::uint32_t tick) const;
    // The Philox key and counter of pair(), for kernels that draw for many entities.
    std::uint32_t pair_key() const { return low_; }
    std::uint32_t pair_counter(std::uint32_t tick) const { return high_ ^ tick; }

  private:
    std::uint32_t low_, high_;
};

/// Converts a word to a uniform number in [0, 1). The number has 24 bits, which a float represents exactly.
inline float unit_float(std::uint32_t word) {
    return static_cast<float>(word >> 8) * 0x1p-24f;
}

/// A sequence of draws for one entity at one tick, for code that does not know beforehand how many draws it needs.
class RandomStream {
  public:
    /// Begins a stream, from which at most 2^34 words can be drawn.
    RandomStream(const RandomKey& key, std::uint32_t entity, std::uint64_t tick = 0)
        : key_{key}, tick_{tick}, entity_{entity} {}

    std::uint32_t word() {
        if (used_ == 4) {
            words_ = key_.words(entity_, tick_, block_++);
            used_ = 0;
        }
        return words_[used_++];
    }
    std::uint64_t long_word() {
        const std::uint64_t high = word();
        return high << 32 | word();
    }
    /// Returns a number that is uniform in [0, 1), with 53 random bits; draws two words.
    double uniform() { return static_cast<double>(long_word() >> 11) * 0x1p-53; }
    /// Returns a number that is uniform in [low, high); draws two words.
    double uniform(double low, double high) { return low + (high - low) * uniform(); }
    /// Returns a number that is uniform in 0 … bound − 1, without bias; bound >= 1 (Lemire 2019, "Fast random integer
    /// generation in an interval").
    std::uint32_t below(std::uint32_t bound) {
        EVOD_ASSERT(bound >= 1);
        std::uint64_t product = std::uint64_t{word()} * bound;
        if (static_cast<std::uint32_t>(product) < bound) [[unlikely]] {
            const std::uint32_t threshold = (0u - bound) % bound;
            while (static_cast<std::uint32_t>(product) < threshold) {
                product = std::uint64_t{word()} * bound;
            }
        }
        return static_cast<std::uint32_t>(product >> 32);
    }
    /// Returns true with probability p. Always draws two words, even if p is 0 or 1.
    bool chance(double p) { return uniform() < p; }
    /// Returns a standard normal number (Box & Muller 1958, cosine branch); draws four words.
    double gaussian();
    /// Shuffles so that every order of `items` is equally likely (Fisher & Yates; Durstenfeld 1964).
    template <class T>
    void shuffle(std::span<T> items) {
        for (std::size_t left = items.size(); left > 1; --left) {
            std::swap(items[left - 1], items[below(static_cast<std::uint32_t>(left))]);
        }
    }

  private:
    RandomKey key_;
    std::uint64_t tick_;
    std::uint32_t entity_;
    std::uint32_t block_ = 0;
    std::uint32_t used_ = 4;
    std::array<std::uint32_t, 4> words_{};
};

} // namespace evod::base
