#include "proto/codec/population_csv.h"

#include "proto/text/csv.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>

namespace evod::codec {
namespace {

constexpr std::size_t genes_at = std::string_view{"island,organism,"}.size(); // where the heading names the first gene

Damage wrong_line(std::uint64_t line, const std::string& allowed, std::string_view got) {
    constexpr std::size_t shown_bytes_max = 80;
    return {"line " + std::to_string(line) + ": got \"" + std::string{got.substr(0, shown_bytes_max)} + "\", allowed " +
            allowed};
}

/// Parses a cell. Returns false if it is not a T.
template <class T>
bool parse(std::string_view cell, T& value) {
    const auto read = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    return read.ec == std::errc{} && read.ptr == cell.data() + cell.size();
}

/// The row as text, for a message about it.
std::string joined(std::span<const std::string_view> cells) {
    std::string text;
    for (std::size_t i = 0; i < cells.size(); ++i) {
        text += (i == 0 ? "" : ",") + text::csv_cell(cells[i]);
    }
    return text;
}

} // namespace

Result<Population> read_population(std::istream& in) {
    text::CsvReader rows{in};
    Population population;
    std::vector<std::string>& names = population.gene_names;
    bool good = rows.next();
    const std::string heading = joined(rows.cells());
    good = good && heading.starts_with(population_heading) &&
           (heading.size() == population_heading.size() || heading[population_heading.size()] == ',');
    for (std::size_t i = 2; good && i < rows.cells().size(); ++i) {
        names.emplace_back(rows.cells()[i]);
        good = !names.back().empty() && names.size() <= genes_max;
    }
    if (!good) {
        return wrong_line(
            1, "the heading " + std::string{population_heading} + ", which the names of further genes may follow",
            heading);
    }

    std::vector<std::vector<float>>& islands = population.islands;
    std::vector<float> genes(names.size());
    while (rows.next()) {
        const std::span<const std::string_view> cells = rows.cells();
        std::uint64_t island = 0, organism = 0;
        good = cells.size() == genes.size() + 2 && parse(cells[0], island) && parse(cells[1], organism);
        for (std::size_t i = 0; good && i < genes.size(); ++i) {
            good = parse(cells[i + 2], genes[i]);
        }
        if (!good) {
            return wrong_line(rows.line(), "an island, an organism and " + std::to_string(genes.size()) + " genes",
                              joined(cells));
        }
        if (island == islands.size() && organism == 0) {
            islands.emplace_back();
        }
        const std::uint64_t last = islands.empty() ? 0 : islands.size() - 1;
        const std::uint64_t next = islands.empty() ? 0 : population.organism_count(last);
        if (islands.empty() || island != last || organism != next) {
            return wrong_line(rows.line(),
                              "organism " + std::to_string(next) + " of island " + std::to_string(last) +
                                  ", or the next island",
                              joined(cells));
        }
        islands.back().insert(islands.back().end(), genes.begin(), genes.end());
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
