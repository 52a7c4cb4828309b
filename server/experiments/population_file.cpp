#include "server/experiments/population_file.h"

#include "proto/codec/population_csv.h"
#include "server/files/regular_file.h"
#include "server/protocol/gene_list.h"
#include "server/simulation/founders.h"

#include <algorithm>
#include <memory>
#include <sstream>
#include <utility>
#include <vector>

namespace evod::experiments {

using base::RefusalCode;

namespace {

base::Refusal unfit(const std::string& path, std::vector<base::Violation> violations) {
    return {.code = RefusalCode::InvalidArgument,
            .message = path + ": does not match the parameters of the world",
            .violations = std::move(violations)};
}

/// Reads one file. The genes of the result are in the order of the world's genes.
base::Result<std::vector<evolution::GeneMatrix>> load_islands(const std::string& path,
                                                              const parameters::Parameters& parameters) {
    auto text = files::read_file(path, "a population file", files::population_bytes_max);
    if (!text) {
        return text.error();
    }
    std::istringstream csv{*std::move(text)};
    v1::FreeGeneList list;
    protocol::to_proto(parameters.listed_genes, list);
    const auto read = codec::read_population(csv, list);
    if (!read) {
        return refusal(RefusalCode::InvalidArgument, path + ": " + read.error().what);
    }
    const std::vector<std::string> names = evolution::gene_layout(parameters).names;
    if (!std::ranges::is_permutation(read->gene_names, names)) {
        if (auto wrong = simulation::other_gene(read->gene_names, parameters, "population.gene_names")) {
            return unfit(path, {*std::move(wrong)});
        }
    }
    std::vector<Eigen::Index> row_in_file;
    for (const std::string& name : names) {
        row_in_file.push_back(std::ranges::find(read->gene_names, name) - read->gene_names.begin());
    }
    std::vector<evolution::GeneMatrix> matrices;
    for (std::size_t island = 0; island < read->islands.size(); ++island) {
        const Eigen::Map<const evolution::GeneMatrix> in_file{read->islands[island].data(),
                                                              static_cast<Eigen::Index>(names.size()),
                                                              static_cast<Eigen::Index>(read->organism_count(island))};
        evolution::GeneMatrix& genes = matrices.emplace_back(in_file.rows(), in_file.cols());
        for (Eigen::Index gene = 0; gene < genes.rows(); ++gene) {
            genes.row(gene) = in_file.row(row_in_file[static_cast<std::size_t>(gene)]);
        }
    }
    return matrices;
}

} // namespace

base::Result<simulation::FirstPopulation> load_population(const std::vector<std::string>& paths,
                                                          const parameters::Parameters& parameters) {
    if (paths.empty()) {
        return simulation::FirstPopulation{};
    }
    std::string all; // for messages
    std::vector<evolution::GeneMatrix> islands;
    for (const std::string& path : paths) {
        all += (all.empty() ? "" : ", ") + path;
        const auto loaded = load_islands(path, parameters);
        if (!loaded) {
            return loaded.error();
        }
        islands.resize(std::max(islands.size(), loaded->size()), evolution::GeneMatrix(loaded->front().rows(), 0));
        for (std::size_t island = 0; island < loaded->size(); ++island) {
            const evolution::GeneMatrix& added = (*loaded)[island];
            evolution::GeneMatrix joined(added.rows(), islands[island].cols() + added.cols());
            joined << islands[island], added;
            islands[island] = std::move(joined);
        }
    }
    const simulation::FirstPopulation population =
        std::make_shared<const std::vector<evolution::GeneMatrix>>(std::move(islands));
    // The places that are left are filled with valid organisms, whatever the seed is.
    if (auto faults =
            simulation::faults_of(simulation::completed(population, parameters, {}), parameters, "population");
        !faults.empty()) {
        return unfit(all, std::move(faults));
    }
    return population;
}

} // namespace evod::experiments
