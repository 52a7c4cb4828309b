// Gene mask: a set of genes, one bit each.
#pragma once

#include "server/base/assert.h"

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

namespace evod::evolution {

// Operators are templates on `extent`, the number of genes of a chromosome: body_gene_count, which the compiler then
// uses to unroll loops, or std::dynamic_extent for any number of genes.

/// A number of genes: a constant unless `extent` is dynamic.
template <std::size_t extent>
class GeneCount {
  public:
    constexpr explicit GeneCount(unsigned) {}
    constexpr operator unsigned() const { return extent; }
};
template <>
class GeneCount<std::dynamic_extent> {
  public:
    constexpr explicit GeneCount(unsigned count) : count_{count} {}
    constexpr operator unsigned() const { return count_; }

  private:
    unsigned count_;
};

/// One element per gene.
template <class T, std::size_t extent>
using PerGene = std::conditional_t<extent == std::dynamic_extent, std::vector<T>, std::array<T, extent>>;

template <std::size_t extent = std::dynamic_extent>
class GeneMask {
  public:
    static constexpr unsigned word_bits = 32;

    /// Constructs an empty set.
    constexpr explicit GeneMask(unsigned gene_count) : gene_count_{gene_count} {
        if constexpr (extent == std::dynamic_extent) {
            words_.resize((gene_count + word_bits - 1) / word_bits);
        }
    }

    constexpr bool contains(unsigned gene) const { return (words_[gene / word_bits] >> gene % word_bits & 1) != 0; }
    constexpr unsigned count() const {
        unsigned count = 0;
        for (const std::uint32_t word : words_) {
            count += static_cast<unsigned>(std::popcount(word));
        }
        return count;
    }
    constexpr unsigned gene_count() const { return gene_count_; }

    /// Replaces the set by the set of all other genes.
    constexpr void complement() {
        for (unsigned word = 0; word < words_.size(); ++word) {
            words_[word] ^= all_of(word);
        }
    }
    /// Adds the genes from `first` on that are not in the set, and removes the other ones of them.
    constexpr void flip_from(unsigned first) {
        EVOD_ASSERT(first < gene_count_);
        words_[first / word_bits] ^= all_of(first / word_bits) & ~std::uint32_t{0} << first % word_bits;
        for (unsigned word = first / word_bits + 1; word < words_.size(); ++word) {
            words_[word] ^= all_of(word);
        }
    }
    /// Replaces each word of 32 genes, the first genes in the lowest bits, by next(); bits beyond the genes are
    /// ignored.
    template <class Next>
    constexpr void assign(const Next& next) {
        for (unsigned word = 0; word < words_.size(); ++word) {
            words_[word] = next() & all_of(word);
        }
    }
    constexpr std::span<const std::uint32_t> words() const { return words_; }

    friend bool operator==(const GeneMask& a, const GeneMask& b) { return a.words_ == b.words_; }

  private:
    /// The bits of a word that are genes.
    constexpr std::uint32_t all_of(unsigned word) const {
        const unsigned genes = gene_count_ - word * word_bits;
        return genes >= word_bits ? ~std::uint32_t{0} : (std::uint32_t{1} << genes) - 1;
    }

    static_assert(extent == std::dynamic_extent || extent <= word_bits);
    GeneCount<extent> gene_count_;
    std::conditional_t<extent == std::dynamic_extent, std::vector<std::uint32_t>, std::array<std::uint32_t, 1>>
        words_{};
};

} // namespace evod::evolution
