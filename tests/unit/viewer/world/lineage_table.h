// Lineage tables in CSV, as a server exports them.
#pragma once

#include "client/viewer/world/lineage.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace evod::viewer {

/// The parents of each organism of a generation on one island; empty: the organism has no parents.
using TableGeneration = std::vector<std::vector<std::uint32_t>>;

/// Returns the rows of one generation. The fitness of organism i is 10 i.
inline std::string lineage_rows(std::uint64_t generation, const TableGeneration& organisms) {
    std::string text;
    for (std::size_t i = 0; i < organisms.size(); ++i) {
        text += std::to_string(generation) + ",0," + std::to_string(i) + ",";
        for (std::size_t parent = 0; parent < 2; ++parent) {
            text += organisms[i].empty()
                        ? ",,,"
                        : std::to_string(generation - 1) + ",0," +
                              std::to_string(organisms[i][parent < organisms[i].size() ? parent : 0]) + ",";
        }
        text += std::string{organisms[i].empty()       ? "initial"
                            : organisms[i].size() == 1 ? "survivor"
                                                       : "child"} +
                "," + std::to_string(10 * i) + ",0,0\n";
    }
    return text;
}

constexpr const char* lineage_heading =
    "generation,island,organism,parent_first_generation,parent_first_island,parent_first,parent_second_generation,"
    "parent_second_island,parent_second,origin,fitness,child_count,kept_count\n";

/// Returns a lineage on one island, from generation `first` on.
inline Lineage lineage_of(const std::vector<TableGeneration>& generations, std::uint64_t first = 1) {
    Lineage lineage;
    std::string text = lineage_heading;
    for (std::size_t i = 0; i < generations.size(); ++i) {
        text += lineage_rows(first + i, generations[i]);
    }
    lineage.begin_table();
    lineage.add(text);
    lineage.end_table();
    return lineage;
}

} // namespace evod::viewer
