// HistoryTable: the statistics of ended generations as columns, of each island and of all of them together.
//
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

    /// Takes in generations, in any order; one that is known already is replaced.
    ///
    /// rows  numbers as of core::history_numbers(), the islands of a generation one after another.
    void add(std::span<const std::vector<double>> rows);

    /// Forgets everything but the names of the genes.
    void clear();

    /// They name the columns of genes; until they are told, a gene is called by its number.
    void set_gene_names(std::vector<std::string> names);
    const std::vector<std::string>& gene_names() const { return gene_names_; }

    /// A column of core::history_columns(), a number for each generation that is known, rising. Of all islands
    /// together: the greatest "…best" and "…max", the least "…worst" and "…min", sums of what is counted; means are
    /// weighted by organism_count, deviations are those of everyone together. Nobody can tell the median: it is not a
    /// number. Empty if there is no such column or island.
    std::span<const double> column(Island island, std::string_view name) const;

    std::uint32_t island_count() const { return static_cast<std::uint32_t>(islands_.size()); }
    bool empty() const { return all_.generations().empty(); }
    /// 0 if there is none.
    std::uint64_t last_generation() const;
    /// The last of those that follow `generation` without a gap; `generation` itself if the next one is not known.
    std::uint64_t last_without_gap(std::uint64_t generation) const;

    /// As core::read_history_csv() reads it, by generation, then island.
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

/// What a file says that was written by to_csv(), `evoctl history --csv` or `evoctl export --what generations`. The
/// error says what is wrong with it, or why it cannot be read.
core::Result<HistoryTable> load_history(const std::string& path);

} // namespace evod::viewer
