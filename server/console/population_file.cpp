#include "server/console/population_file.h"

#include "proto/wire/population_csv.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <utility>
#include <vector>

namespace evod::console {

using base::RefusalCode;

base::Result<simulation::FirstPopulation> load_population(const std::string& path,
                                                          const simulation::Parameters& parameters) {
    if (path.empty())
        return simulation::FirstPopulation{};
    std::error_code error;
    if (std::filesystem::is_directory(path, error))
        return refusal(RefusalCode::NotFound, path + ": this is a folder, not a population file");
    std::ifstream file{path, std::ios::binary};
    if (!file)
        return refusal(RefusalCode::NotFound, path + ": cannot be read: " + std::strerror(errno));
    const auto islands = wire::read_population(file);
    if (!islands)
        return refusal(RefusalCode::InvalidArgument, path + ": " + islands.error().what);
    static_assert(wire::population_genes == evolution::gene_count);
    std::vector<evolution::GeneMatrix> matrices;
    for (const std::vector<float>& genes : *islands)
        matrices.push_back(Eigen::Map<const evolution::GeneMatrix>{
            genes.data(), evolution::gene_count, static_cast<Eigen::Index>(genes.size() / evolution::gene_count)});
    const simulation::FirstPopulation population =
        std::make_shared<const std::vector<evolution::GeneMatrix>>(std::move(matrices));
    if (auto faults = faults_of(population, parameters, "population"); !faults.empty())
        return base::Refusal{.code = RefusalCode::InvalidArgument,
                             .message = path + ": a world with these parameters cannot begin so",
                             .violations = std::move(faults)};
    return population;
}

} // namespace evod::console
