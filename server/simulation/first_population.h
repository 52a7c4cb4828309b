// First population: the chromosomes with which a run begins, if the user gives any.
#pragma once

#include "server/base/result.h"
#include "server/evolution/chromosome.h"
#include "server/evolution/free_gene_operators.h"
#include "server/parameters/model_parameters.h"

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace evod::simulation {

/// The chromosomes of the first generation, one matrix per island; nullptr: they are drawn from the seed. Worlds share
/// the matrices, which never change and may be large.
using FirstPopulation = std::shared_ptr<const std::vector<evolution::GeneMatrix>>;

/// Returns whether two first populations have equal genes; 0 and −0 are equal.
bool same(const FirstPopulation& a, const FirstPopulation& b);

/// Returns why a world with these parameters cannot begin with this population: a wrong number of islands, organisms
/// or genes, or genes out of bounds.
///
/// field    name of the population as the sender spells it: "create_world.population". The name of a gene is then
///          "create_world.population[0].organism[17].body_size".
/// returns  at most faults_max violations; empty if the world can begin with the population.
std::vector<base::Violation> faults_of(const FirstPopulation& population, const parameters::Parameters& parameters,
                                       const std::string& field);
constexpr std::size_t faults_max = 20;

/// Returns the first gene of a population that the world does not have at this place, or lacks.
///
/// gene_names  the names of the genes in the population, in order.
/// field       name of `gene_names` as the sender spells it. The field of the violation is then "`field`[6]".
std::optional<base::Violation> other_gene(std::span<const std::string> gene_names,
                                          const parameters::Parameters& parameters, const std::string& field);

/// Adds a violation for every gene outside its bounds, until there are faults_max; the field of a gene is then
/// "`organism`.body_size". A wrong number of genes is one violation of the field "`organism`.genes".
void add_gene_faults(evolution::ConstGenes genes, const evolution::GeneLayout& layout,
                     const evolution::FreeGeneOperators& listed, const std::string& organism,
                     std::vector<base::Violation>& faults);

} // namespace evod::simulation
