#include "server/replay/columns.h"

#include "server/evolution/chromosome.h"
#include "server/parameters/model_parameters.h"
#include "server/protocol/gene_list.h"

namespace evod::replay {

namespace {

constexpr std::size_t moment_columns =
    4; // the columns that both species share: generation, island, end_tick, simulated_s

void write_cells(Table& table, const simulation::GenerationStatistics& statistics,
                 std::span<const std::string> gene_names, bool colony, std::size_t first_column) {
    std::size_t column = 0;
    simulation::for_each_number(statistics, [&](const std::string&, auto value) {
        if (column++ >= first_column) {
            table.number(value);
        }
    });
    simulation::for_each_gene_number(statistics, gene_names,
                                     [&](const std::string&, auto value) { table.number(value); });
    evolution::for_each_number(statistics.account, gene_names, [&](const std::string&, std::optional<double> value) {
        value ? table.number(*value) : table.nothing();
    });
    if (colony) {
        simulation::for_each_colony_number(
            statistics.colony.value_or(simulation::ColonyStatistics{}),
            [&](const std::string&, auto value) { statistics.colony ? table.number(value) : table.nothing(); });
    }
}

} // namespace

ColonyColumns colony_columns_of(const parameters::Parameters& parameters) {
    return parameters.predator_count > 0        ? ColonyColumns::Both
           : parameters::has_births(parameters) ? ColonyColumns::Prey
                                                : ColonyColumns::None;
}

std::vector<std::string> statistics_columns(std::span<const std::string> gene_names, ColonyColumns colony) {
    std::vector<std::string> columns;
    const auto add = [&](const std::string& name, auto) { columns.push_back(name); };
    const simulation::GenerationStatistics any{.genes = std::vector<simulation::GeneStatistics>(gene_names.size())};
    simulation::for_each_number(any, add);
    simulation::for_each_gene_number(any, gene_names, add);
    evolution::for_each_number(std::nullopt, gene_names, add);
    if (colony != ColonyColumns::None) {
        simulation::for_each_colony_number(simulation::ColonyStatistics{}, add);
    }
    if (colony == ColonyColumns::Both) {
        const std::vector<std::string> prey{columns.begin() + moment_columns, columns.end()};
        for (const std::string& column : prey) {
            columns.push_back("predators_" + column);
        }
    }
    return columns;
}

void write_row(Table& table, const simulation::GenerationStatistics& statistics,
               std::span<const std::string> gene_names, ColonyColumns colony) {
    write_cells(table, statistics, gene_names, colony != ColonyColumns::None, 0);
    if (colony == ColonyColumns::Both && !statistics.predators.empty()) {
        write_cells(table, statistics.predators.front(), gene_names, true, moment_columns);
    } else if (colony == ColonyColumns::Both) {
        const std::size_t cells = statistics_columns(gene_names, ColonyColumns::Prey).size() - moment_columns;
        for (std::size_t cell = 0; cell < cells; ++cell) {
            table.nothing();
        }
    }
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
