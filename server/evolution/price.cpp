#include "server/evolution/price.h"

#include "server/base/assert.h"

#include <cstring>
#include <vector>

namespace evod::evolution {
namespace {

constexpr std::size_t organisms_per_block = 8192;
constexpr std::uint32_t parents_prefetched = 16;

/// One number for each of six genes, stored as vectors of two. Compilers process single numbers one by one, which takes
/// twice as long.
class Numbers {
  public:
    Numbers() = default;
    explicit Numbers(const float* genes) {
        for (unsigned pair = 0; pair < pair_count; ++pair) {
            FloatPair floats;
            std::memcpy(&floats, genes + 2 * pair, sizeof floats);
            pairs_[pair] = __builtin_convertvector(floats, Pair);
        }
    }
    void set(unsigned gene, double number) { pairs_[gene / 2][gene % 2] = number; }
    double operator[](unsigned gene) const { return pairs_[gene / 2][gene % 2]; }

    Numbers& operator+=(const Numbers& other) {
        for (unsigned pair = 0; pair < pair_count; ++pair) {
            pairs_[pair] += other.pairs_[pair];
        }
        return *this;
    }
    friend Numbers operator-(Numbers numbers, const Numbers& other) {
        for (unsigned pair = 0; pair < pair_count; ++pair) {
            numbers.pairs_[pair] -= other.pairs_[pair];
        }
        return numbers;
    }
    friend Numbers middle_of(Numbers numbers, const Numbers& other) {
        for (unsigned pair = 0; pair < pair_count; ++pair) {
            numbers.pairs_[pair] = (numbers.pairs_[pair] + other.pairs_[pair]) * 0.5;
        }
        return numbers;
    }

  private:
    static_assert(body_gene_count % 2 == 0);
    static constexpr unsigned pair_count = body_gene_count / 2;
    using Pair = double __attribute__((vector_size(16)));
    using FloatPair = float __attribute__((vector_size(8)));
    Pair pairs_[pair_count] = {};
};

/// Six genes of every organism of a population.
class SixGenes {
  public:
    /// Those from the gene `first` on.
    SixGenes(const GeneMatrix& genes, unsigned first)
        : first_{genes.data() + first}, gene_count_{static_cast<std::size_t>(genes.rows())} {}

    Numbers of(std::uint32_t organism) const { return Numbers{first_ + gene_count_ * organism}; }
    void prefetch(std::uint32_t organism) const {
        const float* const genes = first_ + gene_count_ * organism;
        __builtin_prefetch(genes);
        __builtin_prefetch(genes + body_gene_count - 1);
    }

  private:
    const float* first_;
    std::size_t gene_count_;
};

/// Several sums, each with one number for each of six genes.
template <std::size_t count>
using SumsOf = std::array<Numbers, count>;

/// Computes sums over the organisms [0, organisms): `add(i, sums)` must add the terms of organism i.
template <std::size_t count, class Add>
SumsOf<count> summed(std::size_t organisms, base::Executor& executor, const Add& add) {
    std::vector<SumsOf<count>> blocks((organisms + organisms_per_block - 1) / organisms_per_block);
    executor.parallel_for(organisms, organisms_per_block, [&](base::Range block) {
        SumsOf<count> sums{};
        for (std::size_t i = block.begin; i < block.end; ++i) {
            add(static_cast<std::uint32_t>(i), sums);
        }
        blocks[block.begin / organisms_per_block] = sums;
    });
    SumsOf<count> total{};
    for (const SumsOf<count>& block : blocks) {
        for (std::size_t which = 0; which < count; ++which) {
            total[which] += block[which];
        }
    }
    return total;
}

/// Rounds to the precision of float. g++ 12 leaves out the rounding of some of the numbers in a loop over several.
[[gnu::noinline]] double with_few_digits(double number) {
    return static_cast<double>(static_cast<float>(number));
}

/// Returns a number near the mean of each gene, with few digits. Differences from it are exact, or nearly exact, and
/// their sums are small. The differences of means are therefore more precise than the means themselves.
Numbers centre_of(SixGenes genes, std::size_t organisms, base::Executor& executor) {
    const SumsOf<1> sums =
        summed<1>(organisms, executor, [=](std::uint32_t i, SumsOf<1>& sum) { sum[0] += genes.of(i); });
    Numbers centre;
    for (unsigned gene = 0; gene < body_gene_count; ++gene) {
        centre.set(gene, with_few_digits(sums[0][gene] / static_cast<double>(organisms)));
    }
    return centre;
}

/// Computes the accounts of six genes, from the gene `first` on.
void account_for_genes(unsigned first, const GeneMatrix& before, const GeneMatrix& bred_from, const GeneMatrix& born,
                       std::span<const Parents> parents, base::Executor& executor, SelectionAccount& account) {
    const auto organisms = static_cast<std::size_t>(before.cols());
    const SixGenes as_born{before, first}, used{bred_from, first}, of_descendants{born, first};
    const Numbers centre = centre_of(as_born, organisms, executor);

    const auto population =
        summed<1>(organisms, executor, [&](std::uint32_t i, SumsOf<1>& sums) { sums[0] += as_born.of(i) - centre; });
    // The two sums are those of the genes that breeding used, and of their differences from the genes as born.
    SumsOf<2> seen{population[0], {}};
    if (&before != &bred_from) {
        seen = summed<2>(organisms, executor, [&](std::uint32_t i, SumsOf<2>& sums) {
            const Numbers z = used.of(i);
            sums[0] += z - centre;
            sums[1] += z - as_born.of(i);
        });
    }
    // The three sums have one term per descendant: its genes; the mean of its parents' genes; the difference of the
    // two.
    const auto descent = summed<3>(parents.size(), executor, [&](std::uint32_t i, SumsOf<3>& sums) {
        if (i + parents_prefetched < parents.size()) {
            used.prefetch(parents[i + parents_prefetched].first);
            used.prefetch(parents[i + parents_prefetched].second);
        }
        EVOD_ASSERT(parents[i].first < organisms);
        EVOD_ASSERT(parents[i].second < organisms);
        const Numbers z = of_descendants.of(i);
        const Numbers of_parents = middle_of(used.of(parents[i].first), used.of(parents[i].second));
        sums[0] += z - centre;
        sums[1] += of_parents - centre;
        sums[2] += z - of_parents;
    });

    const auto n = static_cast<double>(organisms), descendants = static_cast<double>(parents.size());
    for (unsigned gene = 0; gene < body_gene_count; ++gene) {
        account[first + gene] = {.selection = descent[1][gene] / descendants - seen[0][gene] / n,
                                 .transmission = descent[2][gene] / descendants,
                                 .migration = seen[1][gene] / n,
                                 .change = descent[0][gene] / descendants - population[0][gene] / n};
    }
}

} // namespace

SelectionAccount account_for(const GeneMatrix& before, const GeneMatrix& bred_from, const GeneMatrix& born,
                             std::span<const Parents> parents, base::Executor& executor) {
    EVOD_ASSERT(before.cols() >= 1);
    EVOD_ASSERT(born.cols() >= 1);
    EVOD_ASSERT(bred_from.cols() == before.cols());
    EVOD_ASSERT(parents.size() == static_cast<std::size_t>(born.cols()));
    EVOD_ASSERT(before.rows() == born.rows());
    if (born.rows() < body_gene_count) {
        SelectionAccount account =
            account_for(with_a_block(before), with_a_block(bred_from), with_a_block(born), parents, executor);
        account.resize(static_cast<std::size_t>(born.rows()));
        return account;
    }
    SelectionAccount account(static_cast<std::size_t>(born.rows()));
    for_each_block_of_genes(static_cast<unsigned>(born.rows()), [&](unsigned first) {
        account_for_genes(first, before, bred_from, born, parents, executor, account);
    });
    return account;
}

} // namespace evod::evolution
