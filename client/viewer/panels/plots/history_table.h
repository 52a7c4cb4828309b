// HistoryTable: stores the statistics of finished generations as columns, for each island and for all islands together.
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
    /// The number of an island; nullopt: all islands together.
    using Island = std::optional<std::uint32_t>;

    /// Adds generations in any order. Replaces generations that the table already contains.
    ///
    /// rows  numbers as returned by core::history_numbers(); the islands of a generation are consecutive.
    void add(std::span<const std::vector<double>> rows);

    /// Clears everything except the names of the genes.
    void clear();

    /// Sets the names of the genes, which the column names contain. Before the first call, the column names contain
    /// gene numbers.
    void set_gene_names(std::vector<std::string> names);
    const std::vector<std::string>& gene_names() const { return gene_names_; }

    /// Returns a column of core::history_columns() with one number per generation, ordered by generation. For all
    /// islands together, columns named "…best" and "…max" contain the greatest number, "…worst" and "…min" the least,
    /// and counts the sum. Means are weighted by organism_count; standard deviations are those of the combined
    /// population. The combined median is unknown (NaN). Returns an empty span if there is no such column or island.
    std::span<const double> column(Island island, std::string_view name) const;

    std::uint32_t island_count() const { return static_cast<std::uint32_t>(islands_.size()); }
    bool empty() const { return all_.generations().empty(); }
    /// Returns the last generation in the table; 0 if the table is empty.
    std::uint64_t last_generation() const;
    /// Returns the last generation up to which no generation after `generation` is missing. Returns `generation` if the
    /// next one is missing.
    std::uint64_t last_without_gap(std::uint64_t generation) const;

    /// Returns CSV text that core::read_history_csv() can read, sorted by generation, then by island.
    std::string to_csv() const;

  private:
    struct Rows {
        std::vector<std::vector<double>> columns;

        const std::vector<double>& generations() const;
        void put(std::span<const double> numbers);
    };

    void store_generation(std::span<const std::vector<double>> rows);

    std::vector<std::string> gene_names_;
    std::vector<std::string> names_; // names of the columns
    std::vector<Rows> islands_;
    Rows all_;
};

/// Reads a file written by to_csv(), `evoctl history --csv` or `evoctl export --what generations`. An error contains
/// the file name and the reason.
core::Result<HistoryTable> load_history(const std::string& path);

} // namespace evod::viewer
