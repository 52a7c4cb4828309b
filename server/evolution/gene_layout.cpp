#include "server/evolution/gene_layout.h"

#include "server/base/assert.h"
#include "server/evolution/brain_layout.h"

namespace evod::evolution {

bool has_body_genes(const Parameters& parameters) {
    return parameters.fitness != FitnessFunction::External || parameters.external_bodies || parameters.free_genes == 0;
}

unsigned gene_count(const Parameters& parameters) {
    return genes_of(GeneGroup::All, parameters).count;
}

GeneRange genes_of(GeneGroup group, const Parameters& parameters) {
    const unsigned body = has_body_genes(parameters) ? body_gene_count : 0, brain = brain_genes(parameters).count;
    switch (group) {
    case GeneGroup::All:
        break;
    case GeneGroup::Body:
        return {0, body};
    case GeneGroup::Brain:
        return {body, brain};
    case GeneGroup::Free:
        return {body + brain, parameters.free_genes};
    }
    return {0, body + brain + parameters.free_genes};
}

GeneRange unlisted_genes_of(GeneGroup group, const Parameters& parameters) {
    GeneRange genes = genes_of(group, parameters);
    if (!parameters.listed_genes.empty() && (group == GeneGroup::All || group == GeneGroup::Free)) {
        genes.count -= parameters.free_genes;
    }
    return genes;
}

GeneBounds gene_bounds(const Parameters& parameters) {
    const double min[body_gene_count] = {parameters.normal_speed_min, parameters.impulse_min,
                                         parameters.body_size_min,    parameters.base_health_min,
                                         parameters.food_radius_min,  parameters.poison_radius_min};
    const double max[body_gene_count] = {parameters.normal_speed_max, parameters.impulse_max,
                                         parameters.body_size_max,    parameters.base_health_max,
                                         parameters.food_radius_max,  parameters.poison_radius_max};
    const unsigned count = gene_count(parameters);
    GeneBounds bounds{Eigen::ArrayXf(count), Eigen::ArrayXf(count)};
    const auto set = [&](GeneRange genes, double least, double most) {
        EVOD_ASSERT(least <= most);
        bounds.min.segment(genes.first, genes.count) = static_cast<float>(least);
        bounds.max.segment(genes.first, genes.count) = static_cast<float>(most);
    };
    for (unsigned gene = 0; gene < genes_of(GeneGroup::Body, parameters).count; ++gene) {
        set({gene, 1}, min[gene], max[gene]);
    }
    const double weight_limit = brain_genes(parameters).limit;
    set(genes_of(GeneGroup::Brain, parameters), -weight_limit, weight_limit);
    const GeneRange free = genes_of(GeneGroup::Free, parameters);
    set(free, parameters.free_gene_min, parameters.free_gene_max);
    unsigned first = free.first;
    for (const FreeGene& gene : parameters.listed_genes.list()) {
        const GeneValues values{gene};
        set({first, gene.count}, double{values.min()}, double{values.max()});
        first += gene.count;
    }
    return bounds;
}

GeneLayout gene_layout(const Parameters& parameters) {
    GeneLayout layout{.names = {}, .groups = {}, .bounds = gene_bounds(parameters)};
    if (has_body_genes(parameters)) {
        layout.names.assign(body_gene_names.begin(), body_gene_names.end());
        layout.groups.assign(body_gene_count, GeneGroup::Body);
    }
    for (const std::string& weight : brain_gene_names(parameters)) {
        layout.names.push_back(weight);
        layout.groups.push_back(GeneGroup::Brain);
    }
    for (const FreeGene& gene : parameters.listed_genes.list()) {
        for (std::uint32_t i = 0; i < gene.count; ++i) {
            layout.names.push_back(gene.kind == FreeGene::Kind::Permutation ? gene.name + std::to_string(i)
                                                                            : gene.name);
        }
    }
    for (std::uint32_t i = 0; i < parameters.free_genes && parameters.listed_genes.empty(); ++i) {
        layout.names.push_back("free" + std::to_string(i));
    }
    layout.groups.resize(layout.names.size(), GeneGroup::Free);
    return layout;
}

} // namespace evod::evolution
