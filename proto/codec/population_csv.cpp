#include "proto/codec/population_csv.h"

#include "proto/codec/gene_texts.h"
#include "proto/text/csv.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>

namespace evod::codec {
namespace {

constexpr std::size_t genes_at = std::string_view{"island,organism,"}.size(); // where the heading names the first gene
constexpr std::size_t shown_bytes_max = 80;

Damage wrong_line(std::uint64_t line, const std::string& allowed, std::string_view got) {
    return {"line " + std::to_string(line) + ": got \"" + std::string{got.substr(0, shown_bytes_max)} + "\", allowed " +
            allowed};
}

/// The row as text, for a message about it.
std::string joined(std::span<const std::string_view> cells) {
    std::string text;
    for (std::size_t i = 0; i < cells.size(); ++i) {
        text += (i == 0 ? "" : ",") + text::csv_cell(cells[i]);
    }
    return text;
}

std::string_view without_blanks(std::string_view cell) {
    const std::size_t first = cell.find_first_not_of(" \t"), last = cell.find_last_not_of(" \t");
    return first == std::string_view::npos ? std::string_view{} : cell.substr(first, last + 1 - first);
}

/// Parses a cell. Returns false if it is not a T.
template <class T>
bool parse(std::string_view cell, T& value) {
    cell = without_blanks(cell);
    const auto read = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    return read.ec == std::errc{} && read.ptr == cell.data() + cell.size();
}

/// Where the columns of a file are.
struct Columns {
    std::size_t island = 0, organism = 0, count = 0;
    std::vector<std::size_t> genes; // in the order of Population::gene_names
};

/// Reads the heading: the names of the columns in any order. A column without a name is ignored if it is the first one,
/// because R writes the names of the rows there.
std::optional<Columns> read_heading(std::span<const std::string_view> cells, std::vector<std::string>& gene_names) {
    Columns columns;
    columns.count = cells.size();
    std::vector<std::string> names;
    for (const std::string_view cell : cells) {
        names.emplace_back(without_blanks(cell));
    }
    const auto take = [&](std::string_view name) {
        const auto found = std::ranges::find(names, name);
        return found == names.end() ? names.size() : static_cast<std::size_t>(found - names.begin());
    };
    const std::size_t first = !names.empty() && names[0].empty() ? 1 : 0;
    std::vector<std::string> sorted{names.begin() + static_cast<std::ptrdiff_t>(std::min(first, names.size())),
                                    names.end()};
    std::ranges::sort(sorted);
    if (std::ranges::adjacent_find(sorted) != sorted.end() || std::ranges::find(sorted, "") != sorted.end()) {
        return std::nullopt;
    }
    columns.island = take("island");
    columns.organism = take("organism");
    if (columns.island == names.size() || columns.organism == names.size()) {
        return std::nullopt;
    }
    std::vector<bool> taken(names.size());
    taken[columns.island] = taken[columns.organism] = true;
    taken[0] = taken[0] || first == 1;
    const auto add_gene = [&](std::size_t column) {
        taken[column] = true;
        columns.genes.push_back(column);
        gene_names.push_back(names[column]);
    };
    for (std::string_view rest = population_heading.substr(genes_at); !rest.empty();) {
        const std::string_view name = rest.substr(0, rest.find(','));
        rest.remove_prefix(std::min(name.size() + 1, rest.size()));
        if (const std::size_t column = take(name); column < names.size()) {
            add_gene(column);
        }
    }
    for (std::size_t column = 0; column < names.size(); ++column) {
        if (!taken[column]) {
            add_gene(column);
        }
    }
    const bool has_genes = !columns.genes.empty() && columns.genes.size() <= genes_max;
    return has_genes ? std::optional{columns} : std::nullopt;
}

/// Parses a number. With a separator other than the comma, a comma may be the decimal point.
bool parse_number(std::string_view cell, char separator, float& gene) {
    if (separator == ',' || cell.find(',') == std::string_view::npos) {
        return parse(cell, gene);
    }
    std::string with_point{cell};
    std::ranges::replace(with_point, ',', '.');
    return parse(with_point, gene);
}

/// Parses a gene. The text of a choice has precedence over an index, because evod writes the text.
bool parse_gene(std::string_view cell, char separator, const GeneTexts& texts, std::size_t place, float& gene) {
    auto index = texts.index_of(place, cell);
    if (!index) {
        index = texts.index_of(place, without_blanks(cell));
    }
    gene = index.value_or(gene);
    return index || parse_number(cell, separator, gene);
}

/// What is wrong with a row that cannot be read: names its first wrong column, and the likely cause.
Damage wrong_row(std::uint64_t line, std::span<const std::string_view> cells, const Columns& columns,
                 const std::string& wrong_column, const std::string& allowed) {
    if (!wrong_column.empty()) {
        return wrong_line(line, allowed + " (column " + wrong_column + ")", joined(cells));
    }
    const std::string cause = cells.size() > columns.count
                                  ? "; if numbers have a decimal comma, write a point, or separate cells by semicolons"
                                  : "";
    return wrong_line(
        line, allowed + ", so " + std::to_string(columns.count) + " cells, not " + std::to_string(cells.size()) + cause,
        joined(cells));
}

} // namespace

Result<Population> read_population(std::istream& in, const v1::FreeGeneList& list) {
    text::CsvReader rows{in, text::Separator::FromHeading};
    Population population;
    const bool has_heading = rows.next();
    const auto columns = has_heading ? read_heading(rows.cells(), population.gene_names) : std::nullopt;
    if (!columns) {
        return wrong_line(1, "the heading island,organism and the names of the genes, in any order, each name once",
                          joined(rows.cells()));
    }

    const GeneTexts texts{list, population.gene_names};
    std::vector<std::vector<float>>& islands = population.islands;
    std::map<std::uint64_t, std::size_t> index_of_island;
    std::vector<float> genes(population.gene_names.size());
    while (rows.next()) {
        const std::span<const std::string_view> cells = rows.cells();
        if (std::ranges::all_of(cells, [](std::string_view cell) { return without_blanks(cell).empty(); })) {
            continue; // spreadsheet programs write empty rows
        }
        const std::string allowed = "an island, an organism and " + std::to_string(genes.size()) + " genes";
        if (cells.size() != columns->count) {
            return wrong_row(rows.line(), cells, *columns, "", allowed);
        }
        std::uint64_t island = 0, organism = 0;
        std::string choices, wrong = !parse(cells[columns->island], island)       ? "island"
                                     : !parse(cells[columns->organism], organism) ? "organism"
                                                                                  : "";
        for (std::size_t i = 0; wrong.empty() && i < genes.size(); ++i) {
            if (!parse_gene(cells[columns->genes[i]], rows.separator(), texts, i, genes[i])) {
                wrong = population.gene_names[i];
                choices = texts.all(i);
            }
        }
        if (!wrong.empty()) {
            return wrong_row(rows.line(), cells, *columns, wrong, choices.empty() ? allowed : "one of " + choices);
        }
        const auto [place, is_new] = index_of_island.try_emplace(island, islands.size());
        if (is_new) {
            islands.emplace_back();
        }
        std::vector<float>& there = islands[place->second];
        there.insert(there.end(), genes.begin(), genes.end());
    }
    if (rows.has_open_quote()) {
        return Damage{"line " + std::to_string(rows.line()) + ": a quotation mark is not closed"};
    }
    if (in.bad()) {
        return Damage{std::string{"cannot be read: "} + std::strerror(errno)};
    }
    if (islands.empty()) {
        return Damage{"contains no organism"};
    }
    std::vector<std::vector<float>> in_order; // by the number of the island
    for (const auto& [number, index] : index_of_island) {
        in_order.push_back(std::move(islands[index]));
    }
    islands = std::move(in_order);
    return population;
}

std::string population_text(const Population& population) {
    std::string text{population_heading.substr(0, genes_at - 1)};
    for (const std::string& name : population.gene_names) {
        text += "," + text::csv_cell(name);
    }
    text += "\n";
    const std::size_t gene_count = population.gene_names.size();
    for (std::size_t island = 0; island < population.islands.size(); ++island) {
        const std::vector<float>& genes = population.islands[island];
        for (std::size_t first = 0; first < genes.size(); first += gene_count) {
            text += std::to_string(island) + "," + std::to_string(first / gene_count);
            for (std::size_t gene = first; gene < first + gene_count; ++gene) {
                std::array<char, 32> digits; // the longest float has 15 characters
                text += ",";
                text.append(digits.data(), std::to_chars(digits.begin(), digits.end(), genes[gene]).ptr);
            }
            text += "\n";
        }
    }
    return text;
}

} // namespace evod::codec
