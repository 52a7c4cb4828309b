// HistoryTable: the statistics of finished generations as columns, for each island and for all islands together.
//
// Owner        PlotsPanel.
// Threads      none.
#pragma once

#include "client/core/history_csv.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace evod::viewer {

class HistoryTable {
  public:
    /// Nullopt: all islands together.
    using Island = std::optional<std::uint32_t>;

    /// Adds generations in any order; replaces a generation that it already has.
    ///
    /// rows  numbers as returned by core::history_numbers(), the islands of a generation one after another.
    void add(std::span<const std::vector<double>> rows);

    /// Clears everything except the names of the genes.
    void clear();

    /// Names the columns of the genes; before the first call they have numbers.
    void set_gene_names(std::vector<std::string> names);
    const std::vector<std::string>& gene_names() const { return gene_names_; }

    /// A column of core::history_columns() with one number per generation, in rising order of generations. For all
    /// islands together: the greatest of "…best" and "…max", the least of "…worst" and "…min", the sum of counts, means
    /// weighted by organism_count, and standard deviations of the joint population. The joint median is unknown (NaN).
    /// Empty if there is no such column or island.
    std::span<const double> column(Island island, std::string_view name) const;

    std::uint32_t island_count() const { return static_cast<std::uint32_t>(islands_.size()); }
    bool empty() const { return all_.generations().empty(); }
    /// 0 if the table is empty.
    std::uint64_t last_generation() const;
    /// The last generation reached from `generation` without a gap; `generation` itself if the next one is missing.
    std::uint64_t last_without_gap(std::uint64_t generation) const;

    /// The CSV that core::read_history_csv() reads, sorted by generation, then island.
    std::string to_csv() const;

  private:
    struct Rows {
        std::vector<std::vector<double>> columns;

        const std::vector<double>& generations() const;
        void put(std::span<const double> numbers);
    };

    void put_generation(std::span<const std::vector<double>> rows);

    std::vector<std::string> gene_names_;
    std::vector<std::string> names_; // of the columns
    std::vector<Rows> islands_;
    Rows all_;
};

/// Reads a file written by to_csv(), `evoctl history --csv` or `evoctl export --what generations`. The error names the
/// file and the fault.
core::Result<HistoryTable> load_history(const std::string& path);

} // namespace evod::viewer
