#include "server/run_file/more_genes.h"

#include "server/evolution/gene_layout.h"

namespace evod::run_file {

MoreGenesTable::Row more_genes_row(std::uint64_t generation, std::uint64_t island, std::size_t first,
                                   const std::vector<simulation::GeneStatistics>& statistics,
                                   const std::optional<evolution::SelectionAccount>& account) {
    MoreGenesTable::Row row{.generation = generation, .island = island, .statistics = {}, .account = {}};
    for (std::size_t gene = first; gene < statistics.size(); ++gene) {
        const simulation::GeneStatistics& of = statistics[gene];
        row.statistics.insert(row.statistics.end(), {of.mean, of.deviation, of.min, of.max});
    }
    for (std::size_t gene = first; account && gene < account->size(); ++gene) {
        const evolution::GeneAccount& of = (*account)[gene];
        row.account.insert(row.account.end(), {of.selection, of.transmission, of.migration, of.change});
    }
    return row;
}

bool add_account(const MoreGenesTable::Row& row, const parameters::Parameters& parameters,
                 std::optional<evolution::SelectionAccount>& account) {
    if (!evolution::has_body_genes(parameters) && !row.account.empty()) {
        account.emplace();
    }
    for (std::size_t i = 0; account && i + 3 < row.account.size(); i += 4) {
        account->push_back({row.account[i], row.account[i + 1], row.account[i + 2], row.account[i + 3]});
    }
    return row.account.size() % 4 == 0 &&
           (account ? account->size() == evolution::gene_count(parameters) : row.account.empty());
}

bool add_statistics(const MoreGenesTable::Row& row, const parameters::Parameters& parameters,
                    std::vector<simulation::GeneStatistics>& genes) {
    if (!evolution::has_body_genes(parameters)) {
        genes.clear(); // the columns contain 0
    }
    for (std::size_t i = 0; i + 3 < row.statistics.size(); i += 4) {
        genes.push_back({row.statistics[i], row.statistics[i + 1], row.statistics[i + 2], row.statistics[i + 3]});
    }
    return row.statistics.size() % 4 == 0 && genes.size() == evolution::gene_count(parameters);
}

} // namespace evod::run_file
