// Pages of a population, as a server sends them.
#pragma once

#include "evod/v1/commands.pb.h"

#include <bit>
#include <cstdint>
#include <string>
#include <vector>

namespace evod::viewer {

inline void put(std::string& bytes, std::uint32_t number) {
    for (unsigned i = 0; i < 4; ++i) {
        bytes.push_back(static_cast<char>(number >> (8 * i)));
    }
}
inline void put(std::string& bytes, float number) {
    put(bytes, std::bit_cast<std::uint32_t>(number));
}

/// Organisms with genes 100 · gene + id, all seeking a target at (id, 2 id)
/// with a force of (1, id).
inline evod::v1::Population page_of(std::uint32_t first, std::uint32_t count, std::uint32_t organism_count,
                                    std::uint64_t generation = 4, std::uint32_t gene_count = 2) {
    evod::v1::Population page;
    page.set_generation(generation);
    page.set_generation_tick(77);
    page.set_organism_count(organism_count);
    page.set_first(first);
    page.set_count(count);
    const auto column = [&](std::string& bytes, auto value) {
        for (std::uint32_t id = first; id < first + count; ++id) {
            put(bytes, value(id));
        }
    };
    for (std::uint32_t gene = 0; gene < gene_count; ++gene) {
        column(*page.mutable_genes(), [&](std::uint32_t id) { return static_cast<float>(100 * gene + id); });
    }
    page.mutable_choices()->assign(count, static_cast<char>(evod::v1::CHOICE_SEEK));
    column(*page.mutable_forces(), [](std::uint32_t) { return 1.f; });
    column(*page.mutable_forces(), [](std::uint32_t id) { return static_cast<float>(id); });
    column(*page.mutable_targets(), [](std::uint32_t id) { return static_cast<float>(id); });
    column(*page.mutable_targets(), [](std::uint32_t id) { return static_cast<float>(2 * id); });
    return page;
}

} // namespace evod::viewer
