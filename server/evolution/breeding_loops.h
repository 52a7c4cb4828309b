// Breeding loops: apply the steps of breeding to all organisms of an island.
//
// The loops are compiled twice: next_generation.cpp contains the code for chromosomes of the genes of the body alone,
// and next_generation_wide.cpp that for any number of genes. In one file, GCC would inline fewer functions into the
// faster loop.
//
// Threads  none of its own; the executor processes pairs and survivors in blocks.
#pragma once

#include "server/evolution/breeding.h"

#include <algorithm>
#include <numeric>

namespace evod::evolution {
namespace {

constexpr std::size_t pairs_per_piece = 512;
constexpr std::size_t survivors_per_piece = 1024;
constexpr std::size_t pairs_prefetched = 8;

template <std::size_t extent>
class Breeding {
  public:
    Breeding(const GeneMatrix& genes, const Parameters& parameters, const BreedingKey& key, base::Executor& executor)
        : present_{genes}, executor_{executor}, descent_{genes, parameters, key} {}

    /// Copies the survivors, and mutates all of them except the first `kept`.
    void keep(std::span<const std::uint32_t> survivors, std::uint32_t kept, NextGeneration& next) const {
        next.clamped_count += counted(survivors.size(), survivors_per_piece, [&](std::size_t i) {
            const auto place = static_cast<std::uint32_t>(i);
            if (i + pairs_prefetched < survivors.size()) {
                prefetch(survivors[i + pairs_prefetched]);
            }
            next.parents[i] = {survivors[i], survivors[i]};
            return descent_.keep(survivors[i], place, place >= kept, column<extent>(next.genes, place),
                                 WithoutRecord{});
        });
    }

    /// Fills the places from `first` on with two children per pair; the last pair may have room for only one.
    void breed(std::span<const Parents> pairs, std::uint32_t first, NextGeneration& next) const {
        const auto organisms = static_cast<std::uint32_t>(next.genes.cols());
        next.clamped_count += counted(pairs.size(), pairs_per_piece, [&](std::size_t i) {
            if (i + pairs_prefetched < pairs.size()) {
                prefetch(pairs[i + pairs_prefetched].first);
                prefetch(pairs[i + pairs_prefetched].second);
            }
            const Parents pair = pairs[i];
            Mixture<extent> mixture{static_cast<unsigned>(present_.rows())};
            descent_.draw_mixture(static_cast<std::uint32_t>(i), mixture);
            unsigned clamped = 0;
            const auto begin = first + 2 * static_cast<std::uint32_t>(i);
            for (std::uint32_t place = begin; place < std::min(begin + 2, organisms); ++place) {
                const Inheritance<extent> inheritance = inheritance_of(pair, mixture.from_second);
                mixture.from_second.complement();
                next.parents[place] = inheritance.parents;
                clamped += descent_.make_child(inheritance, mixture, place, column<extent>(next.genes, place),
                                               WithoutRecord{});
            }
            return clamped;
        });
    }

  private:
    /// Prefetches a chromosome that will be read soon, because parents are scattered over memory.
    void prefetch(std::uint32_t organism) const {
        const auto genes = column<extent>(present_, organism);
        __builtin_prefetch(&genes.front());
        __builtin_prefetch(&genes.back());
    }

    /// Runs `work` for each index and returns the sum of its results.
    template <class Work>
    std::uint64_t counted(std::size_t count, std::size_t grain, const Work& work) const {
        std::vector<std::uint64_t> of_piece((count + grain - 1) / grain);
        executor_.parallel_for(count, grain, [&](base::Range piece) {
            std::uint64_t sum = 0;
            for (std::size_t i = piece.begin; i < piece.end; ++i) {
                sum += work(i);
            }
            of_piece[piece.begin / grain] = sum;
        });
        return std::accumulate(of_piece.begin(), of_piece.end(), std::uint64_t{0});
    }

    const GeneMatrix& present_;
    base::Executor& executor_;
    Descent<extent> descent_;
};

} // namespace

template <std::size_t extent>
void fill(NextGeneration& next, const Choice& choice, const GeneMatrix& genes, const Parameters& parameters,
          const BreedingKey& key, base::Executor& executor) {
    const Breeding<extent> breeding{genes, parameters, key, executor};
    breeding.keep(choice.survivors(), parameters.mutate_survivors ? next.elite_count : next.survivor_count, next);
    breeding.breed(choice.pairs, next.survivor_count, next);
}

/// Calls fill() for any number of genes.
void fill_wide(NextGeneration& next, const Choice& choice, const GeneMatrix& genes, const Parameters& parameters,
               const BreedingKey& key, base::Executor& executor);

} // namespace evod::evolution
