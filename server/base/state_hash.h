// State hash: one 128-bit number for the whole state of a world, independent of how the work was divided among threads.
//
// Each entity's identity and fields are mixed into two 64-bit words. The hash is the sum of these words over all
// entities. It therefore does not depend on the order of entities, on threads or on memory layout, and it can be
// updated when one entity changes.
//
// Source  the finaliser of Steele, Lea & Flood 2014, "Fast splittable pseudorandom number generators" (SplitMix64).
#pragma once

#include <bit>
#include <cstdint>
#include <string>

namespace evod::base {

struct StateHash {
    std::uint64_t low = 0, high = 0;

    StateHash& operator+=(const StateHash& other) {
        low += other.low;
        high += other.high;
        return *this;
    }
    StateHash& operator-=(const StateHash& other) {
        low -= other.low;
        high -= other.high;
        return *this;
    }
    friend StateHash operator+(StateHash a, const StateHash& b) { return a += b; }
    friend bool operator==(const StateHash&, const StateHash&) = default;
};

/// Returns the hash as 32 lower-case hexadecimal digits, high word first.
std::string to_text(const StateHash& hash);

/// Returns the hash as 16 bytes, most significant byte first.
std::string to_bytes(const StateHash& hash);

/// Collects one entity's identity and fields. `kind` distinguishes entities of different kinds with equal ids.
class EntityHash {
  public:
    EntityHash(std::uint32_t kind, std::uint64_t id) : state_{mix((id + 1) * 0x9e3779b97f4a7c15u + kind)} {}

    EntityHash& add(std::uint64_t word) {
        state_ = mix(state_ ^ word);
        return *this;
    }
    EntityHash& add(std::uint32_t a, std::uint32_t b) { return add(std::uint64_t{a} << 32 | b); }
    EntityHash& add(std::int32_t a, std::int32_t b) {
        return add(static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b));
    }
    EntityHash& add(float a, float b) { return add(std::bit_cast<std::uint32_t>(a), std::bit_cast<std::uint32_t>(b)); }

    StateHash finish() const { return {state_, mix(state_ ^ 0xd6e8feb86659fd93u)}; }

  private:
    static constexpr std::uint64_t mix(std::uint64_t z) {
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return z ^ (z >> 31);
    }
    std::uint64_t state_;
};

/// The input of hash_of(): an entity that is hashed in every tick.
struct HashedWords {
    std::uint32_t kind, id;
    std::uint32_t a, b, c, d, e;
};

/// Returns the hash of an entity, like EntityHash, but faster, for entities that are hashed in every tick. It takes six
/// multiplications of 32-bit words, which a kernel computes for several entities at once (hash_lanes.h).
///
/// The fields are multiplied in pairs, each with a key derived from the identity. Each pair is also added unchanged to
/// the other half of the hash. A field is therefore not lost if the other factor is 0.
/// Source  the pairwise products are those of NH (Black, Halevi, Krawczyk, Krovetz & Rogaway 1999, "UMAC").
inline StateHash hash_of(const HashedWords& words) {
    const auto product = [](std::uint64_t a, std::uint64_t b) { return (a & 0xffff'ffff) * (b & 0xffff'ffff); };
    const std::uint32_t key = (words.id + words.kind * 0x85ebca6bu) * 0x9e3779b1u;
    const std::uint32_t a = words.a ^ key, b = words.b ^ key ^ 0x27d4eb2fu;
    const std::uint32_t c = words.c ^ key ^ 0xc2b2ae35u, d = words.d ^ key ^ 0x165667b1u;
    const std::uint64_t fifth = product(words.e ^ key, key ^ 0xd3a2646cu);
    std::uint64_t low = product(a, b) + (c | std::uint64_t{d} << 32) + fifth;
    std::uint64_t high = product(c, d) + (a | std::uint64_t{b} << 32) + (fifth >> 32 | fifth << 32);
    // Each step is invertible, so entities that differ here still differ at the end.
    low += product(high, high >> 32);
    high ^= low >> 32 | low << 32;
    high += product(low, low >> 32);
    low ^= high >> 29;
    return {low, high};
}

} // namespace evod::base
