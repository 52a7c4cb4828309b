#include "client/viewer/panels/plots/history_table.h"

#include "proto/files/input_file.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>

namespace evod::viewer {

namespace {

// Indices of columns in core::history_columns().
constexpr std::size_t generation_column = 0, island_column = 1, count_column = 4, gene_begin = 20;
// Number of columns per gene. The columns of the selection account follow, with the same number per gene.
constexpr std::size_t columns_of_gene = 4;

std::size_t gene_count_from(std::size_t columns) {
    return (columns - gene_begin) / (2 * columns_of_gene);
}

constexpr std::size_t islands_max = 65'536; // no world can have as many islands

/// How the numbers of several islands are combined. Deviation also uses the means, which are in the preceding column;
/// for fitness_deviation they are in fitness_mean.
enum class Combination { First, Greatest, Least, Sum, Mean, Deviation, Unknown };

/// Returns how to combine the numbers in the column with index `column`. `columns` is the total number of columns.
Combination combination_of(std::size_t column, std::size_t columns) {
    using enum Combination;
    constexpr Combination of_all[gene_begin] = {
        First,     // generation
        First,     // island
        Greatest,  // end_tick
        Greatest,  // simulated_s
        Sum,       // organism_count
        Greatest,  // fitness_best
        Mean,      // fitness_mean
        Unknown,   // fitness_median
        Least,     // fitness_worst
        Deviation, // fitness_deviation
        Mean,      // diversity
        Sum,       // alive_count
        Sum,       // starved_count
        Sum,       // poisoned_count
        Sum,       // food_eaten
        Sum,       // poison_eaten
        Sum,       // clamp_count
        Sum,       // too_fast_count
        Sum,       // speed_limit_count
        Unknown,   // best_organism
    };
    constexpr Combination of_gene[columns_of_gene] = {Mean, Deviation, Least, Greatest};
    if (column < gene_begin) {
        return of_all[column];
    }
    const bool is_account = column >= gene_begin + gene_count_from(columns) * columns_of_gene;
    return is_account ? Mean
                      : of_gene[(column - gene_begin) % columns_of_gene]; // all islands have the same population size
}

std::size_t mean_column_for(std::size_t column) {
    return column < gene_begin ? column - 3 : column - 1;
}

/// Combines the rows of all islands of one generation into one row.
std::vector<double> joined(std::span<const std::vector<double>> rows) {
    std::vector<double> all = rows.front();
    if (rows.size() == 1) {
        return all;
    }
    double organisms = 0;
    for (const std::vector<double>& row : rows) {
        organisms += row[count_column];
    }
    for (std::size_t column = 0; column < all.size(); ++column) {
        const auto mean_of = [&](auto number_of) {
            double sum = 0;
            for (const std::vector<double>& row : rows) {
                sum += organisms > 0 ? row[count_column] / organisms * number_of(row)
                                     : number_of(row) / static_cast<double>(rows.size());
            }
            return sum;
        };
        double& number = all[column];
        switch (combination_of(column, all.size())) {
        case Combination::First:
            break;
        case Combination::Greatest:
            for (const std::vector<double>& row : rows) {
                number = std::max(number, row[column]);
            }
            break;
        case Combination::Least:
            for (const std::vector<double>& row : rows) {
                number = std::min(number, row[column]);
            }
            break;
        case Combination::Sum:
            number = 0;
            for (const std::vector<double>& row : rows) {
                number += row[column];
            }
            break;
        case Combination::Mean:
            number = mean_of([&](const auto& row) { return row[column]; });
            break;
        case Combination::Deviation: { // variance within islands plus variance between their means
            const std::size_t mean_column = mean_column_for(column);
            const double mean = mean_of([&](const auto& row) { return row[mean_column]; });
            number = std::sqrt(mean_of([&](const auto& row) {
                const double apart = row[mean_column] - mean;
                return row[column] * row[column] + apart * apart;
            }));
            break;
        }
        case Combination::Unknown:
            number = std::numeric_limits<double>::quiet_NaN();
            break;
        }
    }
    return all;
}

} // namespace

const std::vector<double>& HistoryTable::Rows::generations() const {
    static const std::vector<double> none;
    return columns.empty() ? none : columns[generation_column];
}

void HistoryTable::Rows::put(std::span<const double> numbers) {
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    if (columns.size() < numbers.size()) {
        columns.resize(numbers.size(), std::vector<double>(generations().size(), unknown));
    }
    const std::vector<double>& known = columns[generation_column];
    // The search is nearly always unnecessary, because generations usually arrive in order.
    const auto found = known.empty() || known.back() < numbers[generation_column]
                           ? known.end()
                           : std::lower_bound(known.begin(), known.end(), numbers[generation_column]);
    const std::ptrdiff_t place = found - known.begin();
    const bool replaces = found != known.end() && *found == numbers[generation_column];
    for (std::size_t i = 0; i < columns.size(); ++i) {
        const double number = i < numbers.size() ? numbers[i] : unknown;
        if (replaces) {
            columns[i][static_cast<std::size_t>(place)] = number;
        } else {
            columns[i].insert(columns[i].begin() + place, number);
        }
    }
}

void HistoryTable::add(std::span<const std::vector<double>> rows) {
    while (!rows.empty()) {
        std::size_t end = 1;
        while (end < rows.size() && rows[end][generation_column] == rows[0][generation_column]) {
            ++end;
        }
        store_generation(rows.first(end));
        rows = rows.subspan(end);
    }
}

void HistoryTable::store_generation(std::span<const std::vector<double>> rows) {
    if (names_.empty()) { // until set_gene_names() is called, genes are named by their numbers
        std::vector<std::string> numbers;
        for (std::size_t gene = 0; gene < gene_count_from(rows[0].size()); ++gene) {
            numbers.push_back("gene_" + std::to_string(gene));
        }
        set_gene_names(std::move(numbers));
    }
    for (const std::vector<double>& row : rows) {
        const auto island = static_cast<std::size_t>(row[island_column]);
        if (island >= islands_max) {
            continue;
        }
        islands_.resize(std::max(islands_.size(), island + 1));
        islands_[island].put(row);
    }
    all_.put(joined(rows));
}

void HistoryTable::clear() {
    islands_.clear();
    all_ = {};
}

void HistoryTable::set_gene_names(std::vector<std::string> names) {
    gene_names_ = std::move(names);
    names_ = core::history_columns(gene_names_);
}

std::span<const double> HistoryTable::column(Island island, std::string_view name) const {
    const auto found = std::find(names_.begin(), names_.end(), name);
    if (island && *island >= islands_.size()) {
        return {};
    }
    const auto& columns = island ? islands_[*island].columns : all_.columns;
    const auto index = static_cast<std::size_t>(found - names_.begin());
    return index < columns.size() ? columns[index] : std::span<const double>{};
}

std::uint64_t HistoryTable::last_generation() const {
    return empty() ? 0 : static_cast<std::uint64_t>(all_.generations().back());
}

std::uint64_t HistoryTable::last_without_gap(std::uint64_t generation) const {
    const std::vector<double>& known = all_.generations();
    const auto after = std::upper_bound(known.begin(), known.end(), static_cast<double>(generation));
    // Without a gap, each generation exceeds the previous one by 1. A binary search therefore finds the first gap.
    const auto steps = std::distance(after, known.end());
    std::ptrdiff_t low = 0, high = steps;
    while (low < high) {
        const std::ptrdiff_t middle = (low + high) / 2;
        if (after[middle] == static_cast<double>(generation) + 1 + static_cast<double>(middle)) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return generation + static_cast<std::uint64_t>(low);
}

std::string HistoryTable::to_csv() const {
    std::string text = core::history_heading(gene_names_);
    std::vector<std::size_t> next(islands_.size());
    std::vector<double> numbers;
    for (const double generation : all_.generations()) {
        for (std::size_t island = 0; island < islands_.size(); ++island) {
            const auto& columns = islands_[island].columns;
            if (columns.empty() || next[island] >= columns[generation_column].size() ||
                columns[generation_column][next[island]] != generation) {
                continue;
            }
            numbers.clear();
            for (const std::vector<double>& column : columns) {
                numbers.push_back(column[next[island]]);
            }
            text += core::history_line(numbers);
            ++next[island];
        }
    }
    return text;
}

core::Result<HistoryTable> load_history(const std::string& path) {
    constexpr std::size_t history_bytes_max = 1 << 28;
    const auto text = files::read_input(path, "a table of statistics", history_bytes_max);
    if (!text) {
        return core::Error{core::Error::Kind::Usage, path + ": " + text.error().why};
    }
    auto read = core::read_history_csv(*text);
    if (!read) {
        return core::Error{read.error().kind, path + ": " + read.error().what};
    }
    std::ranges::stable_sort(read->rows, {}, [](const auto& row) { return row[generation_column]; });
    HistoryTable table;
    table.set_gene_names(std::move(read->gene_names));
    table.add(read->rows);
    return table;
}

} // namespace evod::viewer
