// Breeding record: shows how a generation was bred. It contains the wheel and its spins, the tournaments and their
// contestants, the pairs, the crossover of each child and every changed gene. It is computed afterwards from the same
// inputs by the same steps (breeding.h); breeding itself records nothing.
//
// Threads      none of its own.
// Determinism  the descendants equal those of next_generation() bit for bit.
// Cost         as much as the selection and the pairing of next_generation(), for any number of requested rows. Genes
//              are computed only for the requested descendants.
#pragma once

#include "server/evolution/crossover.h"
#include "server/evolution/migration.h"
#include "server/evolution/mutation.h"
#include "server/evolution/next_generation.h"
#include "server/evolution/selection_law.h"

#include <optional>

namespace evod::evolution {

/// The rows of each list that the record contains: at most count_max rows, from the given first row on.
struct WantedRows {
    std::uint32_t first_contender = 0, first_pick = 0, first_descendant = 0;
    std::uint32_t count_max = 0;
};

struct BreedingRecord {
    /// An organism that the selection could pick.
    struct Contender {
        double fitness = 0;
        std::uint32_t rank = 0; // 0: the fittest
        double weight = 0;      // scaled fitness
        double slot_begin = 0;  // where its slot of the wheel begins, in turns; 0 for methods without a wheel
        double slot_end = 0;
        CopiesLaw law{};                   // distribution of its number of copies in all picks
        std::uint32_t copies = 0;          // its actual number of copies in all picks
        std::optional<Migrant> migrant;    // the migrant that replaced it; set by the caller
        std::optional<double> own_fitness; // its true fitness, if `fitness` was shuffled; set by the caller
    };
    struct Pick {
        std::uint32_t organism = 0;
        std::optional<double> turns;             // position on the wheel, in [0, 1)
        std::optional<std::uint32_t> tournament; // index of the tournament that it won
        // The contestants of that tournament, including the winner; empty if there was no tournament, or if it had too
        // many contestants to record.
        std::vector<std::uint32_t> contestants;
    };
    struct Descendant {
        std::uint32_t id = 0;
        Parents parents{};
        std::vector<float> first_genes, second_genes; // genes of the first and of the second parent
        GeneMask<> from_second{0};                    // the genes that come from the second parent
        double second_share = 0; // blend: the weight of the second parent in every gene; otherwise 0
        std::vector<float>
            crossed_genes; // simulated_binary, or genes with a list: after the crossover; otherwise empty
        bool crossed = false;
        // After an order mutation: element i is the index of the gene whose value gene i received.
        std::optional<std::vector<std::uint32_t>> order;
        std::vector<GeneChange> changes;
        std::vector<float> genes; // after all changes
    };

    Places places;
    std::uint32_t contender_count = 0, pick_count = 0;
    std::vector<Contender> contenders;   // in order of index
    std::vector<Pick> picks;             // in the order in which they were made
    std::vector<Descendant> descendants; // in order of index
};

/// Records what next_generation() does with the same arguments.
///
/// rows  the rows of each list that the record contains; a list that does not have these rows is empty.
BreedingRecord record_breeding(std::span<const double> fitness, const GeneMatrix& genes, const Parameters& parameters,
                               std::uint32_t wanted, const BreedingKey& key, const WantedRows& rows,
                               base::Executor& executor);

} // namespace evod::evolution
