#include "server/simulation/world_bytes.h"

namespace evod::simulation {
namespace {

// Measured: the columns of an entity without its genes, with its places in the grids; what an organism of a colony has
// besides; the rest of an island and a world.
constexpr std::size_t bytes_per_organism = 40, bytes_per_body = 92, bytes_per_item = 40, bytes_per_box = 160;
constexpr std::size_t bytes_in_colony = 280;
constexpr std::size_t bytes_per_island = 25'000, bytes_per_world = 18'500;

std::size_t bytes_of(const Island& island) {
    const std::size_t per_organism = bytes_per_organism + (island.is_colony() ? bytes_in_colony : 0);
    return bytes_per_island + static_cast<std::size_t>(island.born().genes.cols()) * per_organism +
           static_cast<std::size_t>(island.born().genes.size()) * sizeof(float) +
           island.bodies().size() * bytes_per_body +
           (std::size_t{island.food().size()} + island.poison().size()) * bytes_per_item +
           island.boxes().size() * bytes_per_box;
}

std::size_t bytes_of(const GenerationRows& rows) {
    const GenerationStatistics& row = rows.front();
    const std::size_t account = row.account ? row.account->size() * sizeof(evolution::GeneAccount) : 0;
    return rows.size() * (sizeof row + row.genes.size() * sizeof(GeneStatistics) + account);
}

} // namespace

std::size_t estimated_bytes(const World& world) {
    std::size_t bytes = bytes_per_world;
    for (std::size_t island = 0; island < world.island_count(); ++island) {
        bytes += bytes_of(world.island(island));
    }
    if (const History& history = world.history(); !history.empty()) {
        bytes += history.size() * bytes_of(history.back()); // all generations have as many rows and genes
    }
    return bytes;
}

} // namespace evod::simulation
