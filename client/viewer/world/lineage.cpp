#include "client/viewer/world/lineage.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <tuple>
#include <utility>

namespace evod::viewer {

namespace {

constexpr std::array<std::string_view, 9> column_names{"generation",          "island",       "organism",
                                                       "parent_first_island", "parent_first", "parent_second_island",
                                                       "parent_second",       "origin",       "fitness"};
enum Column {
    generation_column,
    island_column,
    organism_column,
    first_island_column,
    first_parent_column,
    second_island_column,
    second_parent_column,
    origin_column,
    fitness_column
};

constexpr std::array<std::string_view, 5> origin_names{"initial", "elite", "survivor", "child", "placed"};
constexpr std::uint32_t islands_max = 65'536; // no world can have as many islands

std::vector<std::string_view> cells_of(std::string_view line) {
    std::vector<std::string_view> cells;
    for (std::size_t begin = 0; begin <= line.size();) {
        const std::size_t end = std::min(line.find(',', begin), line.size());
        cells.push_back(line.substr(begin, end - begin));
        begin = end + 1;
    }
    return cells;
}

template <class Number>
std::optional<Number> number_of(std::string_view text) {
    Number number{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    return error == std::errc{} && end == text.data() + text.size() ? std::optional{number} : std::nullopt;
}

} // namespace

void Lineage::begin_table() {
    rest_.clear();
    columns_.clear();
    line_number_ = reading_ = 0;
    read_ = {};
}

std::optional<std::string> Lineage::add(std::string_view part) {
    for (std::size_t end = part.find('\n'); end != std::string_view::npos; end = part.find('\n')) {
        rest_ += part.substr(0, end);
        part.remove_prefix(end + 1);
        ++line_number_;
        if (auto wrong = columns_.empty() ? read_heading(rest_) : add_line(rest_)) {
            return "line " + std::to_string(line_number_) + " of the lineage table: " + *wrong;
        }
        rest_.clear();
    }
    rest_ += part;
    return std::nullopt;
}

std::optional<std::string> Lineage::read_heading(std::string_view line) {
    const std::vector<std::string_view> names = cells_of(line);
    for (const std::string_view name : column_names) {
        const auto found = std::ranges::find(names, name);
        if (found == names.end()) {
            columns_.clear();
            return "there is no column " + std::string{name};
        }
        columns_.push_back(static_cast<std::size_t>(found - names.begin()));
    }
    return std::nullopt;
}

std::optional<std::string> Lineage::add_line(std::string_view line) {
    const std::vector<std::string_view> cells = cells_of(line);
    const auto cell = [&](Column column) {
        return columns_[column] < cells.size() ? cells[columns_[column]] : std::string_view{};
    };
    const auto generation = number_of<std::uint64_t>(cell(generation_column));
    const auto island = number_of<std::uint32_t>(cell(island_column));
    const auto organism = number_of<std::uint32_t>(cell(organism_column));
    if (!generation || *generation == 0 || !island || *island >= islands_max || !organism) {
        return "no organism: \"" + std::string{line} + "\"";
    }
    if (*generation != reading_) {
        store();
        reading_ = *generation;
    }
    // Rows are sorted by island and organism; an island may be empty.
    while (read_.begins.size() <= *island) {
        read_.begins.push_back(static_cast<std::uint32_t>(read_.organisms.size()));
    }
    if (*island + 1 != read_.begins.size() || read_.begins.back() + *organism != read_.organisms.size()) {
        return "organism " + std::to_string(*organism) + " of island " + std::to_string(*island) +
               " is not in its place";
    }
    Organism made{.fitness = std::numeric_limits<float>::quiet_NaN()};
    for (const auto& [index, island_cell, organism_cell] :
         {std::tuple{0u, cell(first_island_column), cell(first_parent_column)},
          std::tuple{1u, cell(second_island_column), cell(second_parent_column)}}) {
        if (organism_cell.empty()) {
            continue;
        }
        const auto of_island = number_of<std::uint32_t>(island_cell);
        const auto parent = number_of<std::uint32_t>(organism_cell);
        if (!of_island || !parent) {
            return "no parent: \"" + std::string{line} + "\"";
        }
        made.parents[index] = index_of(*generation - 1, {*of_island, *parent});
    }
    const auto named = std::ranges::find(origin_names, cell(origin_column));
    made.origin = named == origin_names.end() ? Origin::Child : Origin(named - origin_names.begin());
    made.fitness = number_of<float>(cell(fitness_column)).value_or(made.fitness);
    read_.organisms.push_back(made);
    return std::nullopt;
}

void Lineage::end_table() {
    store();
    reading_ = 0;
}

/// Adds the generation that was read, or replaces it.
void Lineage::store() {
    if (reading_ == 0) {
        return;
    }
    ++version_;
    if (contains(reading_)) {
        Generation& known = generations_[reading_ - first_];
        organism_count_ -= known.organisms.size();
        organism_count_ += read_.organisms.size();
        known = std::exchange(read_, {});
        return;
    }
    if (empty() || reading_ != last() + 1) { // lineage cannot be followed across a missing generation
        generations_.clear();
        organism_count_ = 0;
        first_ = reading_;
        for (Organism& organism : read_.organisms) {
            organism.parents = {none, none};
        }
    }
    organism_count_ += read_.organisms.size();
    generations_.push_back(std::exchange(read_, {}));
    while (organism_count_ > organisms_max && generations_.size() > 1) {
        organism_count_ -= generations_.front().organisms.size();
        generations_.pop_front();
        ++first_;
        for (Organism& organism : generations_.front().organisms) {
            organism.parents = {none, none};
        }
    }
}

std::array<std::uint32_t, 2> Lineage::island_range(std::uint64_t generation, std::uint32_t island) const {
    const Generation& of = at(generation);
    if (island >= of.begins.size()) {
        return {0, 0};
    }
    const std::size_t end = island + 1 < of.begins.size() ? of.begins[island + 1] : of.organisms.size();
    return {of.begins[island], static_cast<std::uint32_t>(end - of.begins[island])};
}

std::uint32_t Lineage::index_of(std::uint64_t generation, Place place) const {
    if (!contains(generation)) {
        return none;
    }
    const auto [begin, count] = island_range(generation, place.island);
    return place.organism < count ? begin + place.organism : none;
}

Lineage::Place Lineage::place_of(std::uint64_t generation, std::uint32_t index) const {
    const std::vector<std::uint32_t>& begins = at(generation).begins;
    const auto island = std::ranges::upper_bound(begins, index) - begins.begin() - 1;
    return {static_cast<std::uint32_t>(island), index - begins[static_cast<std::size_t>(island)]};
}

std::vector<std::uint32_t> ancestors_of(const Lineage& lineage, std::uint64_t generation, std::uint32_t island,
                                        std::uint64_t since) {
    if (!lineage.contains(generation) || !lineage.contains(since) || since > generation) {
        return {};
    }
    const auto [begin, count] = lineage.island_range(generation, island);
    std::vector<std::uint32_t> ancestors(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        ancestors[i] = begin + i;
    }
    for (; generation > since; --generation) {
        for (std::uint32_t& organism : ancestors) {
            if (organism != Lineage::none) {
                organism = lineage.at(generation).organisms[organism].parents[0];
            }
        }
    }
    return ancestors;
}

} // namespace evod::viewer
