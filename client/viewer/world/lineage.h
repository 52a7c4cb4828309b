// Lineage: the parents of the organisms of a run, generation by generation, on all islands.
//
// It is read from the lineage table that the server exports (ExportRun). The table contains the real parents also where
// migrants have replaced organisms. At most `organisms_max` organisms are kept; then the oldest generations are
// removed.
//
// An organism is identified by its generation and its index there: organisms are numbered from 0, island after island,
// as the founders in GetPopulation are.
//
// Owner        LineagePoll.
// Threads      none; used on the drawing thread.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace evod::viewer {

class Lineage {
  public:
    static constexpr std::size_t organisms_max = 500'000;
    static constexpr std::uint32_t none = ~std::uint32_t{0};

    enum class Origin : std::uint8_t { Initial, Elite, Survivor, Child, Placed };
    struct Organism {
        /// Indices of the parents in the previous generation; `none` if unknown. If the organism has one parent, both
        /// are equal.
        std::array<std::uint32_t, 2> parents{none, none};
        float fitness = 0; // NaN if the generation had not ended when it was exported
        Origin origin = Origin::Initial;
    };
    struct Generation {
        std::vector<Organism> organisms;
        std::vector<std::uint32_t> begins; // for each island, the index of its first organism
    };
    struct Place {
        std::uint32_t island = 0, organism = 0; // organism: the id on the island
        friend bool operator==(const Place&, const Place&) = default;
    };

    /// Begins to read a table. It adds generations to those known, and replaces those that it contains.
    void begin_table();
    /// Reads the next part of a table in CSV, which may end within a row. Returns what is wrong with the table, as a
    /// sentence without a full stop; nullopt: nothing.
    std::optional<std::string> add(std::string_view part);
    /// Ends the table. Its last generation is known from now on.
    void end_table();

    bool empty() const { return generations_.empty(); }
    /// The known generations are first() to last(). The parents of organisms in first() are unknown.
    std::uint64_t first() const { return first_; }
    std::uint64_t last() const { return first_ + generations_.size() - 1; }
    bool contains(std::uint64_t generation) const { return !empty() && generation >= first() && generation <= last(); }
    /// Returns the generation, which must be known.
    const Generation& at(std::uint64_t generation) const { return generations_[generation - first_]; }
    /// Returns a number that rises with every change.
    std::uint64_t version() const { return version_; }

    /// Returns the index of an organism; `none` if there is no such organism.
    std::uint32_t index_of(std::uint64_t generation, Place place) const;
    /// Returns the place of the organism with this index in a known generation.
    Place place_of(std::uint64_t generation, std::uint32_t index) const;
    /// Returns the first index and the number of organisms of an island in a known generation; 0 organisms if there is
    /// no such island.
    std::array<std::uint32_t, 2> island_range(std::uint64_t generation, std::uint32_t island) const;

  private:
    std::optional<std::string> add_line(std::string_view line);
    std::optional<std::string> read_heading(std::string_view line);
    void store();

    std::deque<Generation> generations_;
    std::uint64_t first_ = 1, version_ = 0;
    std::size_t organism_count_ = 0;

    // The table being read.
    std::string rest_;                            // the beginning of a row
    std::vector<std::size_t> columns_;            // position in a row of each column that is read
    std::uint64_t line_number_ = 0, reading_ = 0; // reading_: the number of the generation being read; 0: none
    Generation read_;
};

/// Returns the ancestor of each organism of an island, in the generation `since`, found by following first parents: an
/// index in that generation, or Lineage::none. Empty unless both generations are known and `since` <= `generation`.
std::vector<std::uint32_t> ancestors_of(const Lineage& lineage, std::uint64_t generation, std::uint32_t island,
                                        std::uint64_t since);

} // namespace evod::viewer
