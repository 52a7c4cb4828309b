// Small island: an island of 200 × 200 px with the contents that a test sets.
#pragma once

#include "server/base/inline_executor.h"
#include "server/simulation/island.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace evod::simulation {

inline evolution::BodyGenes chromosome_of(float normal_speed, float impulse, float body_size, float base_health,
                                          float food_radius, float poison_radius) {
    evolution::BodyGenes genes;
    genes << normal_speed, impulse, body_size, base_health, food_radius, poison_radius;
    return genes;
}

class SmallIsland : public testing::Test {
  protected:
    SmallIsland() {
        parameters.island_width_px = parameters.island_height_px = 200;
        parameters.food_count = parameters.poison_count = 0;
    }
    void begin(const std::vector<evolution::BodyGenes>& chromosomes) {
        evolution::NextGeneration born;
        born.genes = evolution::GeneMatrix(evolution::body_gene_count, static_cast<Eigen::Index>(chromosomes.size()));
        for (std::size_t i = 0; i < chromosomes.size(); ++i) {
            born.genes.col(static_cast<Eigen::Index>(i)) = chromosomes[i];
        }
        island.begin_generation(parameters, 1, std::move(born), executor);
    }
    void tick() { island.advance_tick(parameters, ++now, executor); }
    float health(std::uint32_t id) { return island.living().health[island.body_of(id).value()]; }
    std::vector<double> fitness() { return island.fitness(parameters, now, executor); }

    parameters::Parameters parameters;
    Island island{base::Seed{1}, 0};
    std::uint32_t now = 0;
    base::InlineExecutor executor;
};

/// Chromosomes of a crowded island on which organisms of both kinds of items eat and some die.
inline std::vector<evolution::BodyGenes> hungry() {
    std::vector<evolution::BodyGenes> chromosomes;
    for (int i = 0; i < 30; ++i) {
        chromosomes.push_back(chromosome_of(50, 100 + static_cast<float>(i), 80, 20, 100, 100));
    }
    return chromosomes;
}

} // namespace evod::simulation
