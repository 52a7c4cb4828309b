#include "proto/codec/population_csv.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <string>

namespace evod::codec {
namespace {

constexpr std::size_t genes_at = std::string_view{"island,organism,"}.size(); // where the heading names the first gene

Damage wrong_line(std::uint64_t line, const std::string& allowed, std::string_view got) {
    constexpr std::size_t shown_bytes_max = 80;
    return {"line " + std::to_string(line) + ": got \"" + std::string{got.substr(0, shown_bytes_max)} + "\", allowed " +
            allowed};
}

/// Parses the next field of a line and removes it from the line. Returns false if the field is not a T.
template <class T>
bool take(std::string_view& line, T& value) {
    const std::string_view field = line.substr(0, line.find(','));
    line.remove_prefix(std::min(line.size(), field.size() + 1));
    const auto read = std::from_chars(field.data(), field.data() + field.size(), value);
    return read.ec == std::errc{} && read.ptr == field.data() + field.size();
}

bool next_line(std::istream& in, std::string& line) {
    if (!std::getline(in, line)) {
        return false;
    }
    if (line.ends_with('\r')) {
        line.pop_back();
    }
    return true;
}

} // namespace

Result<Population> read_population(std::istream& in) {
    std::string line;
    Population population;
    std::vector<std::string>& names = population.gene_names;
    bool good = next_line(in, line) && line.starts_with(population_heading) &&
                (line.size() == population_heading.size() || line[population_heading.size()] == ',');
    for (std::size_t begin = genes_at; good && begin <= line.size();) {
        const std::size_t end = std::min(line.find(',', begin), line.size());
        names.push_back(line.substr(begin, end - begin));
        good = !names.back().empty() && names.size() <= genes_max;
        begin = end + 1;
    }
    if (!good) {
        return wrong_line(
            1, "the heading " + std::string{population_heading} + ", which the names of further genes may follow",
            line);
    }

    std::vector<std::vector<float>>& islands = population.islands;
    std::vector<float> genes(names.size());
    for (std::uint64_t number = 2; next_line(in, line); ++number) {
        std::string_view rest = line;
        std::uint64_t island = 0, organism = 0;
        good = take(rest, island) && take(rest, organism);
        for (float& gene : genes) {
            good = good && take(rest, gene);
        }
        if (!good || !rest.empty() ||
            static_cast<std::size_t>(std::count(line.begin(), line.end(), ',')) != genes.size() + 1) {
            return wrong_line(number, "an island, an organism and " + std::to_string(genes.size()) + " genes", line);
        }
        if (island == islands.size() && organism == 0) {
            islands.emplace_back();
        }
        const std::uint64_t last = islands.empty() ? 0 : islands.size() - 1;
        const std::uint64_t next = islands.empty() ? 0 : population.organism_count(last);
        if (islands.empty() || island != last || organism != next) {
            return wrong_line(number,
                              "organism " + std::to_string(next) + " of island " + std::to_string(last) +
                                  ", or the next island",
                              line);
        }
        islands.back().insert(islands.back().end(), genes.begin(), genes.end());
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
        text += "," + name;
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
