// Price equation: splits the change of each gene's mean from one generation of an island to the next into selection,
// transmission and migration. The numbers are statistics; the simulation never reads them.
//
//   change of the mean  =  selection  +  transmission  +  migration
//                           Cov(w, z)    E(w · Δz)        z̄ − z̄ before migrants arrived
//                           ─────────    ─────────
//                              w̄            w̄
//
// The covariance and the means are taken over the organisms that breeding used, migrants included. z is the gene. w is
// the number of an organism's descendants: each child counts ½ for each of its two parents, and each place in which an
// organism survives counts 1 for it. Δz is the mean difference between the gene of these descendants and that of the
// organism. Crossover, mutation (also of survivors) and bounds are therefore part of transmission.
//
// Threads      none of its own; the executor processes populations in blocks.
// Determinism  each block of fixed size is summed in index order, in double; the sums of the blocks are added in order.
//              The simulation does not depend on the results.
// Source       Price 1970, Nature 227, 520–521, doi:10.1038/227520a0.
#pragma once

#include "server/base/executor.h"
#include "server/evolution/chromosome.h"
#include "server/evolution/pairing.h"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace evod::evolution {

/// The change of one gene's mean and its three parts, in gene units. Each number is summed separately, so the first
/// three add up to the fourth except for rounding.
struct GeneAccount {
    double selection = 0, transmission = 0, migration = 0, change = 0;
    friend bool operator==(const GeneAccount&, const GeneAccount&) = default;
};

/// One account per gene, in chromosome order.
using SelectionAccount = std::vector<GeneAccount>;

/// Computes how the genes changed from the previous generation to this one.
///
/// before     chromosomes of the previous generation as born; at least one.
/// bred_from  the same chromosomes after migration: the places of replaced organisms hold the migrants' chromosomes.
///            May be the same object as `before`.
/// born       chromosomes of this generation; at least one. Their number may differ from that of `before`.
/// parents    shape (born): the parents of each organism in `born`, as indices into bred_from.
SelectionAccount account_for(const GeneMatrix& before, const GeneMatrix& bred_from, const GeneMatrix& born,
                             std::span<const Parents> parents, base::Executor& executor);

/// Calls visit(name, value) for every number of the first genes, in the order of columns in files. A value is a
/// std::optional<double>, nullopt if there is no account.
///
/// gene_names  the names of the genes, in chromosome order; at most as many as the account has.
template <class Names, class Visit>
void for_each_number(const std::optional<SelectionAccount>& account, const Names& gene_names, Visit&& visit) {
    for (std::size_t gene = 0; gene < gene_names.size(); ++gene) {
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

/// The inverse of for_each_number(): reads the account of `gene_count` genes; nullopt if any number is missing.
///
/// next  must return the next number, a std::optional<double>; called once per number, in the order of
///       for_each_number().
template <class Next>
std::optional<SelectionAccount> account_from(std::size_t gene_count, Next&& next) {
    SelectionAccount account(gene_count);
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
