// EvodScene: evod's own world, in the shape in which the engines' scenes are run.
#pragma once

#include "server/simulation/world.h"
#include "tests/bench/engines/scene.h"

namespace evod::bench {

class EvodScene {
  public:
    EvodScene(const parameters::Parameters& parameters, base::Seed seed) : world_{parameters, seed} {}

    std::uint64_t alive_count() const { return world_.alive_count(); }
    void advance_tick(base::Executor& executor) { world_.advance_tick(executor); }

    Counts counts() const {
        Counts counts;
        for (const simulation::Island& island : world_.islands()) {
            const simulation::LiveStatistics live = island.live_statistics();
            counts.food_eaten += live.food_eaten;
            counts.poison_eaten += live.poison_eaten;
            counts.deaths += live.starved_count + live.poisoned_count;
        }
        return counts;
    }

    /// Of the first island.
    Observation observation() const {
        Observation observation;
        const simulation::Island& island = world_.islands()[0];
        const evolution::GeneMatrix& genes = island.born().genes;
        for (std::uint32_t id = 0; id < genes.cols(); ++id) {
            if (const auto i = island.body_of(id)) {
                observation.organisms.push_back(
                    {.place = {physics::to_px(island.bodies().x[*i]), physics::to_px(island.bodies().y[*i])},
                     .velocity = {static_cast<double>(island.bodies().velocity_x[*i]),
                                  static_cast<double>(island.bodies().velocity_y[*i])},
                     .food_radius = static_cast<double>(genes(evolution::FoodRadius, id))});
            }
        }
        for (std::uint32_t item = 0; item < island.food().size(); ++item) {
            if (island.food().present(item)) {
                observation.food.push_back(
                    {physics::to_px(island.food().all()[item].x), physics::to_px(island.food().all()[item].y)});
            }
        }
        return observation;
    }

  private:
    simulation::World world_;
};

} // namespace evod::bench
