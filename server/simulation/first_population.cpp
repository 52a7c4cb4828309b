#include "server/simulation/first_population.h"

#include <algorithm>
#include <string_view>

namespace evod::simulation {
namespace {

std::string counted(std::size_t count, const char* what) {
    return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

/// Returns the names of the parameters that contain a gene's bounds.
std::string bound_parameters(const evolution::GeneLayout& layout, unsigned gene) {
    switch (layout.groups[gene]) {
    case evolution::GeneGroup::Brain:
        return "brain_weight_limit";
    case evolution::GeneGroup::Free:
        return "free_gene_min, free_gene_max";
    default:
        return layout.names[gene] + "_min, " + layout.names[gene] + "_max";
    }
}

} // namespace

bool same(const FirstPopulation& a, const FirstPopulation& b) {
    if (!a || !b) {
        return !a && !b;
    }
    return std::ranges::equal(*a, *b, [](const evolution::GeneMatrix& one, const evolution::GeneMatrix& other) {
        return one.rows() == other.rows() && one.cols() == other.cols() && (one == other).all();
    });
}

std::optional<base::Violation> other_gene(std::span<const std::string> gene_names,
                                          const parameters::Parameters& parameters, const std::string& field) {
    const std::vector<std::string> of_world = evolution::gene_layout(parameters).names;
    const auto [given, wanted] = std::ranges::mismatch(gene_names, of_world);
    if (given == gene_names.end() && wanted == of_world.end()) {
        return std::nullopt;
    }
    const auto gene = [](auto name, const auto& names) {
        return name == names.end() ? std::string{"no gene"} : "the gene " + *name;
    };
    return base::Violation{field + "[" + std::to_string(given - gene_names.begin()) + "]", gene(wanted, of_world),
                           gene(given, gene_names)};
}

std::vector<base::Violation> faults_of(const FirstPopulation& population, const parameters::Parameters& parameters,
                                       const std::string& field) {
    std::vector<base::Violation> faults;
    if (!population) {
        return faults;
    }
    if (population->size() != parameters.island_count) {
        faults.push_back({field, counted(parameters.island_count, "island") + " (island_count)",
                          counted(population->size(), "island")});
    }
    const evolution::GeneLayout layout = evolution::gene_layout(parameters);
    const evolution::FreeGeneOperators listed{parameters};
    for (std::size_t island = 0; island < population->size(); ++island) {
        const evolution::GeneMatrix& genes = (*population)[island];
        const std::string name = field + "[" + std::to_string(island) + "]";
        if (faults.size() < faults_max && genes.cols() != parameters.population_size) {
            faults.push_back({name, counted(parameters.population_size, "organism") + " (population_size)",
                              counted(static_cast<std::size_t>(genes.cols()), "organism")});
        }
        for (std::uint32_t organism = 0; organism < genes.cols() && faults.size() < faults_max; ++organism) {
            add_gene_faults(evolution::column(genes, organism), layout, listed,
                            name + ".organism[" + std::to_string(organism) + "]", faults);
        }
    }
    return faults;
}

void add_gene_faults(evolution::ConstGenes genes, const evolution::GeneLayout& layout,
                     const evolution::FreeGeneOperators& listed, const std::string& organism,
                     std::vector<base::Violation>& faults) {
    const std::size_t before = faults.size();
    if (genes.size() != layout.names.size()) {
        faults.push_back(
            {organism + ".genes", counted(layout.names.size(), "number"), counted(genes.size(), "number")});
        return;
    }
    for (unsigned gene = 0; gene < genes.size() && faults.size() < faults_max; ++gene) {
        const float value = genes[gene], min = layout.bounds.min[gene], max = layout.bounds.max[gene];
        if (value >= min && value <= max) { // a NaN is in no range
            continue;
        }
        faults.push_back({organism + "." + layout.names[gene],
                          parameters::to_text(parameters::ParameterValue{double{min}}) + " to " +
                              parameters::to_text(parameters::ParameterValue{double{max}}) + " (" +
                              (layout.groups[gene] == evolution::GeneGroup::Free && !listed.empty()
                                   ? "its entry in the list"
                                   : bound_parameters(layout, gene)) +
                              ")",
                          parameters::to_text(parameters::ParameterValue{double{value}})});
    }
    if (const auto gene = faults.size() == before ? listed.first_fault(genes) : std::nullopt) {
        faults.push_back(
            {organism + "." + layout.names[*gene],
             "a value that the list of the free genes allows: on a step of a number, the index of a choice, "
             "each element of a permutation once",
             parameters::to_text(parameters::ParameterValue{double{genes[*gene]}})});
    }
}

} // namespace evod::simulation
