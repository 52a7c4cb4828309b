#include "server/protocol/gene_list.h"

#include "server/parameters/gene_list.h"

#include <algorithm>

namespace evod::protocol {
namespace {

using Kind = evolution::FreeGene::Kind;

evolution::FreeGene to_gene(const v1::FreeGene& message) {
    evolution::FreeGene gene;
    gene.name = message.name();
    gene.choices = {message.choices().begin(), message.choices().end()};
    if (message.permutation() > 0) {
        gene.kind = Kind::Permutation;
        gene.count = message.permutation();
    } else if (!gene.choices.empty()) {
        gene.kind = Kind::Choice;
    } else {
        gene.min = message.min();
        gene.max = message.max();
        gene.step = message.step();
        gene.logarithmic = message.logarithmic();
        gene.mutation_step = message.mutation_step();
    }
    return gene;
}

} // namespace

evolution::FreeGenes to_gene_list(const v1::FreeGeneList& message, std::string_view field,
                                  std::vector<base::Violation>& violations) {
    constexpr int most = 1000;
    if (message.genes_size() > most) {
        violations.push_back({std::string{field}, "at most 1000 genes", std::to_string(message.genes_size())});
        return {};
    }
    std::vector<evolution::FreeGene> list;
    for (int i = 0; i < message.genes_size(); ++i) {
        const v1::FreeGene& gene = message.genes(i);
        if (gene.permutation() > 0 && gene.choices_size() > 0) {
            violations.push_back(
                {std::string{field} + "[" + std::to_string(i) + "]", "choices or a permutation", "both"});
            return {};
        }
        list.push_back(to_gene(gene));
    }
    const auto faults = parameters::faults_of(list, field);
    violations.insert(violations.end(), faults.begin(), faults.end());
    return faults.empty() ? evolution::FreeGenes{std::move(list)} : evolution::FreeGenes{};
}

void to_proto(const evolution::FreeGenes& genes, v1::FreeGeneList& message) {
    for (const evolution::FreeGene& gene : genes.list()) {
        v1::FreeGene& to = *message.add_genes();
        to.set_name(gene.name);
        switch (gene.kind) {
        case Kind::Number:
            to.set_min(gene.min);
            to.set_max(gene.max);
            to.set_step(gene.step);
            to.set_logarithmic(gene.logarithmic);
            to.set_mutation_step(gene.mutation_step);
            break;
        case Kind::Choice:
            to.mutable_choices()->Add(gene.choices.begin(), gene.choices.end());
            break;
        case Kind::Permutation:
            to.set_permutation(gene.count);
            break;
        }
    }
}

} // namespace evod::protocol
