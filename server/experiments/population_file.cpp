#include "server/experiments/population_file.h"

#include "proto/codec/population_csv.h"
#include "server/files/regular_file.h"

#include <memory>
#include <sstream>
#include <utility>
#include <vector>

namespace evod::experiments {

using base::RefusalCode;

namespace {

constexpr std::size_t population_bytes_max = std::size_t{1} << 30; // a million organisms take about 70 MB

} // namespace

base::Result<simulation::FirstPopulation> load_population(const std::string& path,
                                                          const parameters::Parameters& parameters) {
    if (path.empty()) {
        return simulation::FirstPopulation{};
    }
    auto text = files::read_file(path, "a population file", population_bytes_max);
    if (!text) {
        return text.error();
    }
    std::istringstream csv{*std::move(text)};
    const auto islands = codec::read_population(csv);
    if (!islands) {
        return refusal(RefusalCode::InvalidArgument, path + ": " + islands.error().what);
    }
    static_assert(codec::population_genes == evolution::gene_count);
    std::vector<evolution::GeneMatrix> matrices;
    for (const std::vector<float>& genes : *islands) {
        matrices.push_back(Eigen::Map<const evolution::GeneMatrix>{
            genes.data(), evolution::gene_count, static_cast<Eigen::Index>(genes.size() / evolution::gene_count)});
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
