#include "server/experiments/population_file.h"

#include "proto/codec/population_csv.h"
#include "server/files/regular_file.h"

#include <memory>
#include <sstream>
#include <utility>
#include <vector>

namespace evod::experiments {

using base::RefusalCode;

base::Result<simulation::FirstPopulation> load_population(const std::string& path,
                                                          const parameters::Parameters& parameters) {
    if (path.empty()) {
        return simulation::FirstPopulation{};
    }
    auto text = files::read_file(path, "a population file", files::population_bytes_max);
    if (!text) {
        return text.error();
    }
    std::istringstream csv{*std::move(text)};
    const auto read = codec::read_population(csv);
    if (!read) {
        return refusal(RefusalCode::InvalidArgument, path + ": " + read.error().what);
    }
    if (auto wrong = simulation::other_gene(read->gene_names, parameters, "population.gene_names")) {
        return base::Refusal{.code = RefusalCode::InvalidArgument,
                             .message = path + ": does not match the parameters of the world",
                             .violations = {*std::move(wrong)}};
    }
    std::vector<evolution::GeneMatrix> matrices;
    for (std::size_t island = 0; island < read->islands.size(); ++island) {
        matrices.push_back(Eigen::Map<const evolution::GeneMatrix>{
            read->islands[island].data(), static_cast<Eigen::Index>(read->gene_names.size()),
            static_cast<Eigen::Index>(read->organism_count(island))});
    }
    const simulation::FirstPopulation population =
        std::make_shared<const std::vector<evolution::GeneMatrix>>(std::move(matrices));
    if (auto faults = simulation::faults_of(population, parameters, "population"); !faults.empty()) {
        return base::Refusal{.code = RefusalCode::InvalidArgument,
                             .message = path + ": does not match the parameters of the world",
                             .violations = std::move(faults)};
    }
    return population;
}

} // namespace evod::experiments
