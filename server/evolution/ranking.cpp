#include "server/evolution/ranking.h"

#include <array>
#include <bit>

namespace evod::evolution {
namespace {

constexpr unsigned digit_bits = 8;
constexpr unsigned digit_count = 64 / digit_bits;
constexpr std::size_t digit_values = std::size_t{1} << digit_bits;

struct Entry {
    std::uint64_t key; // smaller for a greater fitness
    std::uint32_t organism;
};

/// The bits of a double order like the number itself once the sign bit, and for a negative number all others, are
/// turned over; turned over once more, the greatest number comes first.
std::uint64_t descending_key(double fitness) {
    const auto bits = std::bit_cast<std::uint64_t>(fitness + 0.0); // −0 becomes 0
    constexpr std::uint64_t sign = std::uint64_t{1} << 63;
    return (bits & sign) != 0 ? bits : ~(bits | sign);
}

std::size_t digit(std::uint64_t key, unsigned place) {
    return key >> (place * digit_bits) & (digit_values - 1);
}

} // namespace

std::span<const std::uint32_t> Ranking::best_first() {
    const std::size_t population = fitness_.size();
    if (best_first_.size() == population)
        return best_first_;

    std::vector<Entry> entries(population), sorted(population);
    std::array<std::array<std::uint32_t, digit_values>, digit_count> starts{};
    for (std::size_t i = 0; i < population; ++i) {
        entries[i] = {descending_key(fitness_[i]), static_cast<std::uint32_t>(i)};
        for (unsigned place = 0; place < digit_count; ++place)
            ++starts[place][digit(entries[i].key, place)];
    }
    for (unsigned place = 0; place < digit_count; ++place) {
        if (starts[place][digit(entries[0].key, place)] == population)
            continue; // all have the same digit here
        std::uint32_t start = 0;
        for (std::uint32_t& count : starts[place]) {
            const std::uint32_t next = start + count;
            count = start;
            start = next;
        }
        for (const Entry& entry : entries)
            sorted[starts[place][digit(entry.key, place)]++] = entry;
        entries.swap(sorted);
    }
    best_first_.resize(population);
    for (std::size_t rank = 0; rank < population; ++rank)
        best_first_[rank] = entries[rank].organism;
    return best_first_;
}

} // namespace evod::evolution
