#include "server/replay/columns.h"

#include "server/evolution/chromosome.h"

namespace evod::replay {

std::vector<std::string> statistics_columns() {
    std::vector<std::string> columns;
    simulation::for_each_number(simulation::GenerationStatistics{},
                                [&](const std::string& name, auto) { columns.push_back(name); });
    evolution::for_each_number(std::nullopt, [&](const std::string& name, auto) { columns.push_back(name); });
    return columns;
}

void write_row(Table& table, const simulation::GenerationStatistics& statistics) {
    simulation::for_each_number(statistics, [&](const std::string&, auto value) { table.number(value); });
    evolution::for_each_number(statistics.account, [&](const std::string&, std::optional<double> value) {
        value ? table.number(*value) : table.nothing();
    });
    table.end_row();
}

std::vector<std::string> population_columns() {
    std::vector<std::string> columns{"island", "organism"};
    columns.insert(columns.end(), evolution::gene_names.begin(), evolution::gene_names.end());
    return columns;
}

} // namespace evod::replay
