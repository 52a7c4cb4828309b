// Families: the lineages of a population. A family consists of all organisms with the same ancestor in one earlier
// generation, found by following first parents.
//
// Owner        Population, for the ancestors in the first generation; IslandView, for those in a later one.
// Threads      none.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace evod::viewer {

class Families {
  public:
    struct Family {
        std::uint32_t founder = 0; // number of the ancestor
        std::size_t size = 0;      // number of organisms in the population
    };
    static constexpr std::size_t shown_max = 7;
    static constexpr std::uint8_t none = shown_max; // the family is unknown, or too small to be shown

    Families() = default;
    /// founders  the ancestor of each organism, by id; `unknown` where there is none.
    explicit Families(std::span<const std::uint32_t> founders);
    static constexpr std::uint32_t unknown = ~std::uint32_t{0};

    /// Returns the largest families, by decreasing size; among equal sizes, the lower founder comes first.
    const std::vector<Family>& shown() const { return shown_; }
    /// Returns the number of all families.
    std::size_t count() const { return count_; }
    /// Returns the number of organisms in all families.
    std::size_t size() const { return size_; }
    /// Returns the family of an organism, as an index in shown(), or `none`.
    std::uint8_t of(std::uint32_t id) const { return id < of_.size() ? of_[id] : none; }

  private:
    std::vector<Family> shown_;
    std::vector<std::uint8_t> of_;
    std::size_t count_ = 0, size_ = 0;
};

} // namespace evod::viewer
