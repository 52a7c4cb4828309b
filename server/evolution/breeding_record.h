// Breeding record: how a generation came to be: the wheel and its turns, the tournaments and their contestants, the
// pairs, the cuts, every gene that moved. Worked out again from what went in, by the same steps (breeding.h); nothing
// of it is kept while a generation is bred.
//
// Threads      none of its own.
// Determinism  the descendants are those of next_generation() bit for bit.
// Cost         as the selection and the pairing of next_generation(), whatever part is wanted; the genes are worked out
//              of those descendants alone that are told of.
#pragma once

#include "server/evolution/crossover.h"
#include "server/evolution/migration.h"
#include "server/evolution/mutation.h"
#include "server/evolution/next_generation.h"

#include <array>
#include <optional>

namespace evod::evolution {

/// Which part of each list is wanted: from there on, so many.
struct WantedRows {
    std::uint32_t first_contender = 0, first_pick = 0, first_descendant = 0;
    std::uint32_t count_max = 0;
};

struct BreedingRecord {
    /// An organism as the selection saw it.
    struct Contender {
        double fitness = 0;
        std::uint32_t rank = 0; // 0: the fittest
        double weight = 0;      // scaled fitness
        double slot_begin = 0;  // of the wheel, in turns; 0 where none is spun
        double slot_end = 0;
        double expected_copies = 0; // of all the picks
        std::uint32_t copies = 0;
        std::optional<Migrant> migrant;    // that came and took its place; set by who knows of the migration
        std::optional<double> own_fitness; // what it came to, if `fitness` was shuffled; set by who knows of that
    };
    struct Pick {
        std::uint32_t organism = 0;
        std::optional<double> turns;             // of the wheel, in [0, 1)
        std::optional<std::uint32_t> tournament; // index of the one that it won
        std::vector<std::uint32_t> contestants;  // its own among them; empty if there are none, or too many to tell
    };
    struct Descendant {
        std::uint32_t id = 0;
        Parents parents{};
        Chromosome first_genes, second_genes; // of the parents
        GeneMask from_second = 0;             // the genes that come of the second parent
        bool crossed = false;
        std::optional<std::array<std::uint32_t, gene_count>> order; // rearranged: whose value each gene has got
        std::vector<GeneChange> changes;
        Chromosome genes; // that came of it
    };

    Places places;
    std::uint32_t contender_count = 0, pick_count = 0;
    std::vector<Contender> contenders;   // by index
    std::vector<Pick> picks;             // in the order in which they were made
    std::vector<Descendant> descendants; // by index
};

/// What next_generation() does, given the same. rows: of which it tells; a list that does not go so far is empty.
BreedingRecord record_breeding(std::span<const double> fitness, const GeneMatrix& genes, const Parameters& parameters,
                               std::uint32_t wanted, const BreedingKey& key, const WantedRows& rows,
                               base::Executor& executor);

} // namespace evod::evolution
