// Price: what the mean of each gene did from one generation of an island to the next, and which part of that was
// selection, which transmission and which migration. An account of what happened, that nothing reads back.
//
//   change of the mean  =  selection  +  transmission  +  migration
//                           Cov(w, z)    E(w · Δz)        z̄ − z̄ of before migrants came
//                           ─────────    ─────────
//                              w̄            w̄
//
// over the organisms that breeding saw, migrants among them: z, the gene; w, how many descendants an organism has, ½
// for each child that it is one of two parents of, 1 for each place that it is kept in itself; Δz, how far the genes of
// those descendants are from its own, on average. So crossover, mutation, of survivors too, and bounds are
// transmission.
//
// Threads      none of its own; populations are gone through in blocks given to the executor.
// Determinism  sums are taken in double by index, over blocks of fixed size, whose sums are added in order; no number
// of
//              the simulation follows from them.
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

/// Of one gene, in its units. Each is summed up for itself, so that the first three together are the fourth but for
/// rounding.
struct GeneAccount {
    double selection = 0, transmission = 0, migration = 0, change = 0;
    friend bool operator==(const GeneAccount&, const GeneAccount&) = default;
};

/// Of every gene, in chromosome order.
using SelectionAccount = std::array<GeneAccount, gene_count>;

/// How a generation came from the one before.
///
/// before     chromosomes of that one as they were born; at least one.
/// bred_from  the same as breeding saw them: with those of migrants in the places that they took over. May be `before`.
/// born       chromosomes of the generation; at least one, and not always as many.
/// parents    of those, in bred_from; shape (born).
SelectionAccount account_for(const GeneMatrix& before, const GeneMatrix& bred_from, const GeneMatrix& born,
                             std::span<const Parents> parents, base::Executor& executor);

/// Calls visit(name, value) for every number, in the order in which files have them as columns; a value is a
/// std::optional<double>, nothing where there is no account.
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

/// The account of which for_each_number() tells; nothing if any number is missing.
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
