// Price equation: splits the change of each gene's mean from one generation of an island to the next into selection,
// transmission and migration. The numbers are statistics; the simulation never reads them.
//
//   change of the mean  =  selection  +  transmission  +  migration
//                           Cov(w, z)    E(w · Δz)        z̄ − z̄ before migrants arrived
//                           ─────────    ─────────
//                              w̄            w̄
//
// The sums run over the organisms that breeding saw, migrants included. z is the gene. w is the number of an organism's
// descendants: ½ for each child that it is one of two parents of, 1 for each place in which it survives. Δz is the mean
// difference between the genes of these descendants and its own. Crossover, mutation (also of survivors) and bounds are
// therefore transmission.
//
// Threads      none of its own; the executor processes populations in blocks.
// Determinism  sums are taken in double by index, over blocks of fixed size, whose sums are added in order. No number
//              of the simulation depends on them.
// Source       Price 1970, Nature 227, 520–521, doi:10.1038/227520a0.
#pragma once

#include "server/base/executor.h"
#include "server/evolution/chromosome.h"
#include "server/evolution/pairing.h"

#include <array>
#include <optional>
#include <span>
#include <string>

namespace evod::evolution {

/// The account of one gene, in its units. Each number is summed separately, so the first three add up to the fourth
/// except for rounding.
struct GeneAccount {
    double selection = 0, transmission = 0, migration = 0, change = 0;
    friend bool operator==(const GeneAccount&, const GeneAccount&) = default;
};

/// One account per gene, in chromosome order.
using SelectionAccount = std::array<GeneAccount, gene_count>;

/// Computes how a generation developed from the previous one.
///
/// before     chromosomes of the previous generation as they were born; at least one.
/// bred_from  the same after migration: the places of replaced organisms hold the migrants' chromosomes. May be
///            `before`.
/// born       chromosomes of the generation; at least one; their number may differ.
/// parents    of the organisms in `born`, as indices into bred_from; shape (born).
SelectionAccount account_for(const GeneMatrix& before, const GeneMatrix& bred_from, const GeneMatrix& born,
                             std::span<const Parents> parents, base::Executor& executor);

/// Calls visit(name, value) for every number, in the order of columns in files. A value is a std::optional<double>,
/// nullopt if there is no account.
template <class Visit>
void for_each_number(const std::optional<SelectionAccount>& account, Visit&& visit) {
    for (unsigned gene = 0; gene < gene_count; ++gene) {
        const auto number = [&](const char* name, double GeneAccount::*of) {
            visit(std::string{gene_names[gene]} + name,
                  account ? std::optional{(*account)[gene].*of} : std::optional<double>{});
        };
        number("_selection", &GeneAccount::selection);
        number("_transmission", &GeneAccount::transmission);
        number("_migration", &GeneAccount::migration);
        number("_change", &GeneAccount::change);
    }
}

/// The inverse of for_each_number(): reads an account; nullopt if any number is missing.
///
/// next  called for each number in that order: std::optional<double>().
template <class Next>
std::optional<SelectionAccount> account_from(Next&& next) {
    SelectionAccount account;
    bool whole = true;
    for (GeneAccount& gene : account) {
        for (double* number : {&gene.selection, &gene.transmission, &gene.migration, &gene.change}) {
            const std::optional<double> value = next();
            whole &= value.has_value();
            *number = value.value_or(0);
        }
    }
    return whole ? std::optional{account} : std::nullopt;
}

} // namespace evod::evolution
