#include "client/core/history_csv.h"

#include "proto/text/csv.h"
#include "proto/text/number_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <limits>
#include <sstream>

namespace evod::core {

namespace {

/// Calls visit(name, number) for every column that does not belong to a gene.
template <class Visit>
void for_each_number(const evod::v1::GenerationStatistics& s, Visit visit) {
    visit("generation", s.generation());
    visit("island", s.island());
    visit("end_tick", s.end_tick());
    visit("simulated_s", s.simulated_s());
    visit("organism_count", s.organism_count());
    visit("fitness_best", s.fitness_best());
    visit("fitness_mean", s.fitness_mean());
    visit("fitness_median", s.fitness_median());
    visit("fitness_worst", s.fitness_worst());
    visit("fitness_deviation", s.fitness_deviation());
    visit("diversity", s.diversity());
    visit("alive_count", s.alive_count());
    visit("starved_count", s.starved_count());
    visit("poisoned_count", s.poisoned_count());
    visit("food_eaten", s.food_eaten());
    visit("poison_eaten", s.poison_eaten());
    visit("clamp_count", s.clamp_count());
    visit("too_fast_count", s.too_fast_count());
    visit("speed_limit_count", s.speed_limit_count());
    visit("best_organism", s.best_organism());
}

/// Calls visit(name, number) for every column that only colonies have.
template <class Visit>
void for_each_colony_number(const evod::v1::ColonyStatistics& s, Visit visit) {
    visit("first_count", s.first_count());
    visit("lowest_count", s.lowest_count());
    visit("count_mean", s.count_mean());
    visit("born_count", s.born_count());
    visit("refused_count", s.refused_count());
    visit("without_room_count", s.without_room_count());
    visit("eaten_count", s.eaten_count());
    visit("old_count", s.old_count());
    visit("died_count", s.died_count());
    visit("children_mean", s.children_mean());
    visit("children_variance", s.children_variance());
    visit("age_mean_s", s.age_mean_s());
}

constexpr std::size_t moment_columns =
    4; // the columns that both species share: generation, island, end_tick, simulated_s

constexpr std::string_view gene_parts[] = {"_mean", "_deviation", "_min", "_max"};
constexpr std::string_view account_parts[] = {"_selection", "_transmission", "_migration", "_change"};

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

Error misread(std::string what) {
    return {Error::Kind::Usage, std::move(what)};
}

} // namespace

ColonyColumns colony_columns_of(const google::protobuf::RepeatedPtrField<evod::v1::GenerationStatistics>& generations) {
    return {.colony = std::ranges::any_of(generations, &evod::v1::GenerationStatistics::has_colony),
            .predators = std::ranges::any_of(generations, &evod::v1::GenerationStatistics::has_predators)};
}

std::vector<std::string> history_columns(std::span<const std::string> gene_names, ColonyColumns with) {
    std::vector<std::string> columns;
    for_each_number({}, [&](const char* name, auto) { columns.emplace_back(name); });
    for (const std::string& gene : gene_names) {
        for (const std::string_view part : gene_parts) {
            columns.push_back(gene + std::string{part});
        }
    }
    for (const std::string& gene : gene_names) {
        for (const std::string_view part : account_parts) {
            columns.push_back(gene + std::string{part});
        }
    }
    if (with.colony) {
        for_each_colony_number({}, [&](const char* name, auto) { columns.emplace_back(name); });
    }
    if (with.predators) {
        const std::vector<std::string> prey{columns.begin() + moment_columns, columns.end()};
        for (const std::string& column : prey) {
            columns.push_back("predators_" + column);
        }
    }
    return columns;
}

std::vector<double> history_numbers(const evod::v1::GenerationStatistics& statistics, ColonyColumns with) {
    std::vector<double> numbers;
    for_each_number(statistics, [&](const char*, auto number) { numbers.push_back(static_cast<double>(number)); });
    for (const evod::v1::GeneStatistics& gene : statistics.genes()) {
        numbers.insert(numbers.end(), {gene.mean(), gene.deviation(), gene.min(), gene.max()});
    }
    for (const evod::v1::GeneStatistics& gene : statistics.genes()) {
        if (!gene.has_account()) {
            numbers.insert(numbers.end(), std::size(account_parts), unknown);
            continue;
        }
        const evod::v1::GeneAccount& account = gene.account();
        numbers.insert(numbers.end(),
                       {account.selection(), account.transmission(), account.migration(), account.change()});
    }
    if (with.colony) {
        for_each_colony_number(statistics.colony(), [&](const char*, auto number) {
            numbers.push_back(statistics.has_colony() ? static_cast<double>(number) : unknown);
        });
    }
    if (with.predators) {
        const std::size_t prey_count = numbers.size() - moment_columns;
        if (statistics.has_predators()) {
            const std::vector<double> of = history_numbers(statistics.predators(), {.colony = with.colony});
            numbers.insert(numbers.end(), of.begin() + moment_columns, of.end());
        } else {
            numbers.insert(numbers.end(), prey_count, unknown);
        }
    }
    return numbers;
}

std::string history_heading(const std::vector<std::string>& gene_names, ColonyColumns with) {
    std::string heading;
    for (const std::string& column : history_columns(gene_names, with)) {
        heading += (heading.empty() ? "" : ",") + text::csv_cell(column);
    }
    return heading + "\n";
}

std::string history_line(std::span<const double> numbers) {
    std::string line;
    for (const double number : numbers) {
        line += (line.empty() ? "" : ",") +
                (std::isnan(number) ? std::string{} : text::number_text(number, text::Exponent::IfLong));
    }
    return line + "\n";
}

Result<HistoryCsv> read_history_csv(std::string_view text) {
    std::istringstream in{std::string{text}};
    text::CsvReader lines{in};
    lines.next();
    const std::vector<std::string> heading(lines.cells().begin(), lines.cells().end());
    HistoryCsv read;
    for (const std::string_view name : heading) {
        const std::string gene{name.substr(0, name.size() - std::min(name.size(), gene_parts[0].size()))};
        if (name.ends_with(gene_parts[0]) && gene != "fitness") {
            read.gene_names.push_back(gene);
        }
    }
    const std::vector<std::string> columns = history_columns(read.gene_names);
    const std::size_t account_begin = columns.size() - read.gene_names.size() * std::size(account_parts);
    std::vector<std::size_t> places; // index of each column in the file; past the end if an older file lacks the column
    for (const std::string& column : columns) {
        const auto found = std::find(heading.begin(), heading.end(), column);
        if (found == heading.end() && places.size() < account_begin) {
            return misread("line 1: there is no column " + column +
                           "; the columns must be those of evoctl export --what generations");
        }
        places.push_back(static_cast<std::size_t>(found - heading.begin()));
    }
    while (lines.next()) {
        const std::span<const std::string_view> cells = lines.cells();
        if (cells.size() == 1 && cells[0].empty()) {
            continue;
        }
        const std::string line = "line " + std::to_string(lines.line());
        if (cells.size() != heading.size()) {
            return misread(line + " has " + std::to_string(cells.size()) +
                           " cells, allowed: " + std::to_string(heading.size()) + ", as many as the heading");
        }
        std::vector<double>& row = read.rows.emplace_back();
        for (std::size_t i = 0; i < columns.size(); ++i) {
            const std::string_view cell = places[i] < cells.size() ? cells[places[i]] : std::string_view{};
            if (i >= account_begin && cell.empty()) {
                row.push_back(unknown);
                continue;
            }
            double value = 0;
            const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
            if (error != std::errc{} || end != cell.data() + cell.size() || !std::isfinite(value)) {
                return misread(line + ", " + columns[i] + ": must be a number, not \"" +
                               std::string{cell.substr(0, 40)} + "\"");
            }
            row.push_back(value);
        }
        for (std::size_t i = 0; i < 2; ++i) {
            if (row[i] != std::floor(row[i]) || row[i] < (i == 0 ? 1 : 0) || row[i] >= (i == 0 ? 1e15 : 65'536)) {
                return misread(line + ", " + columns[i] + ": must be a whole number from " +
                               (i == 0 ? "1" : "0 to 65535") + ", not " +
                               text::number_text(row[i], text::Exponent::IfLong));
            }
        }
    }
    if (lines.has_open_quote()) {
        return misread("line " + std::to_string(lines.line()) + ": a quotation mark is not closed");
    }
    return read;
}

} // namespace evod::core
