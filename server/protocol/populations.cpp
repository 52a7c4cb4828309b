#include "server/protocol/populations.h"

#include <algorithm>
#include <utility>

namespace evod::protocol {

simulation::FirstPopulation first_population_of(const v1::CreateWorld& request,
                                                const parameters::Parameters& parameters,
                                                std::vector<base::Violation>& violations) {
    if (request.population().empty()) {
        return nullptr;
    }
    if (!request.population_gene_names().empty()) {
        const std::vector<std::string> names{request.population_gene_names().begin(),
                                             request.population_gene_names().end()};
        if (auto other = simulation::other_gene(names, parameters, "create_world.population_gene_names")) {
            violations.push_back(*std::move(other));
            return nullptr;
        }
    }
    const unsigned gene_count = evolution::gene_count(parameters);
    std::vector<evolution::GeneMatrix> islands;
    bool whole = true;
    for (int island = 0; island < request.population_size(); ++island) {
        const auto& genes = request.population(island).genes();
        evolution::GeneMatrix& matrix = islands.emplace_back(gene_count, genes.size() / static_cast<int>(gene_count));
        if (matrix.size() == genes.size()) {
            std::copy(genes.begin(), genes.end(), matrix.data());
            continue;
        }
        whole = false;
        violations.push_back({"create_world.population[" + std::to_string(island) + "].genes",
                              "a multiple of " + std::to_string(gene_count) + " numbers",
                              std::to_string(genes.size())});
    }
    return whole ? std::make_shared<const std::vector<evolution::GeneMatrix>>(std::move(islands)) : nullptr;
}

void add_population(v1::CreateWorld& request, const simulation::FirstPopulation& population) {
    if (!population) {
        return;
    }
    for (const evolution::GeneMatrix& genes : *population) {
        request.add_population()->mutable_genes()->Add(genes.data(), genes.data() + genes.size());
    }
}

} // namespace evod::protocol
