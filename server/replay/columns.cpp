#include "server/replay/columns.h"

#include "server/evolution/chromosome.h"
#include "server/protocol/gene_list.h"

namespace evod::replay {

std::vector<std::string> statistics_columns(std::span<const std::string> gene_names) {
    std::vector<std::string> columns;
    const auto add = [&](const std::string& name, auto) { columns.push_back(name); };
    const simulation::GenerationStatistics any{.genes = std::vector<simulation::GeneStatistics>(gene_names.size())};
    simulation::for_each_number(any, add);
    simulation::for_each_gene_number(any, gene_names, add);
    evolution::for_each_number(std::nullopt, gene_names, add);
    return columns;
}

void write_row(Table& table, const simulation::GenerationStatistics& statistics,
               std::span<const std::string> gene_names) {
    const auto add = [&](const std::string&, auto value) { table.number(value); };
    simulation::for_each_number(statistics, add);
    simulation::for_each_gene_number(statistics, gene_names, add);
    evolution::for_each_number(statistics.account, gene_names, [&](const std::string&, std::optional<double> value) {
        value ? table.number(*value) : table.nothing();
    });
    table.end_row();
}

std::vector<std::string> population_columns(std::span<const std::string> gene_names) {
    std::vector<std::string> columns{"island", "organism"};
    columns.insert(columns.end(), gene_names.begin(), gene_names.end());
    return columns;
}

std::vector<std::string> gene_names_of(const parameters::Parameters& parameters) {
    return evolution::gene_layout(parameters).names;
}

codec::GeneTexts gene_texts_of(const parameters::Parameters& parameters) {
    v1::FreeGeneList list;
    protocol::to_proto(parameters.listed_genes, list);
    return {list, gene_names_of(parameters)};
}

void write_gene(Table& table, const codec::GeneTexts& texts, std::size_t gene, float value) {
    const std::string* const choice = texts.choice(gene, value);
    choice != nullptr ? table.text(*choice) : table.number(value);
}

std::vector<std::string> body_gene_names() {
    return {evolution::body_gene_names.begin(), evolution::body_gene_names.end()};
}

} // namespace evod::replay
