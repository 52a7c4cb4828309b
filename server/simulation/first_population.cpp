#include "server/simulation/first_population.h"

#include <algorithm>
#include <string_view>

namespace evod::simulation {
namespace {

std::string counted(std::size_t count, const char* what) {
    return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

} // namespace

bool same(const FirstPopulation& a, const FirstPopulation& b) {
    if (!a || !b) {
        return !a && !b;
    }
    return std::ranges::equal(*a, *b, [](const evolution::GeneMatrix& one, const evolution::GeneMatrix& other) {
        return one.cols() == other.cols() && (one == other).all();
    });
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
    const evolution::GeneBounds bounds = evolution::gene_bounds(parameters);
    for (std::size_t island = 0; island < population->size(); ++island) {
        const evolution::GeneMatrix& genes = (*population)[island];
        const std::string name = field + "[" + std::to_string(island) + "]";
        if (faults.size() < faults_max && genes.cols() != parameters.population_size) {
            faults.push_back({name, counted(parameters.population_size, "organism") + " (population_size)",
                              counted(static_cast<std::size_t>(genes.cols()), "organism")});
        }
        for (Eigen::Index organism = 0; organism < genes.cols() && faults.size() < faults_max; ++organism) {
            add_gene_faults(genes.col(organism), bounds, name + ".organism[" + std::to_string(organism) + "]", faults);
        }
    }
    return faults;
}

void add_gene_faults(const evolution::Chromosome& genes, const evolution::GeneBounds& bounds,
                     const std::string& organism, std::vector<base::Violation>& faults) {
    for (Eigen::Index gene = 0; gene < genes.rows() && faults.size() < faults_max; ++gene) {
        const float value = genes[gene];
        if (value >= bounds.min[gene] && value <= bounds.max[gene]) { // a NaN is in no range
            continue;
        }
        const std::string named{evolution::gene_names[static_cast<std::size_t>(gene)]};
        faults.push_back({organism + "." + named,
                          parameters::to_text(parameters::ParameterValue{double{bounds.min[gene]}}) + " to " +
                              parameters::to_text(parameters::ParameterValue{double{bounds.max[gene]}}) + " (" + named +
                              "_min, " + named + "_max)",
                          parameters::to_text(parameters::ParameterValue{double{value}})});
    }
}

} // namespace evod::simulation
