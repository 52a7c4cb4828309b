// Births: which organisms of an island have children in a tick, what their parents pay, and where they are placed.
//
// docs/MODEL.md, "Births", states the rules. Parents are searched in the order of their ids, first among the prey, then
// among the predators, on one thread.
//
// Determinism  the draws for a child are keyed by (seed, purpose, island, interval, tick) and the id of its first
//              parent. Those of predators use the index of the island + 2^31.
#include "server/simulation/island.h"

#include "server/base/elementary.h"
#include "server/evolution/breeding.h"

#include <algorithm>
#include <cmath>

namespace evod::simulation {
namespace {

/// With shuffle_births: so many births of a species are the latest ones.
constexpr std::size_t latest_births = 256;

} // namespace

/// The search for parents and for places of their children in one tick.
class Island::Nursery {
  public:
    /// parameters  of the prey.
    Nursery(Island& island, const parameters::Parameters& parameters, std::uint32_t tick)
        : island_{island}
        , tick_{tick}
        , organisms_max_{parameters::interval_organisms_max(parameters)}
        , boxes_{island.area_, island.boxes_}
        , room_{island.area_, island.alive_count_}
        , has_child_(island.bodies_.size()) {
        const physics::Circles& bodies = island.bodies_;
        for (std::size_t body = 0; body < bodies.size(); ++body) {
            if (!bodies.is_void(body)) {
                room_.add({bodies.x[body], bodies.y[body]}, bodies.radius[body]);
            }
        }
    }

    /// Finds the children of a species, and lets their parents pay.
    ///
    /// parameters  of the species.
    void search(Species species, const parameters::Parameters& parameters);

    std::vector<NewOrganism> children;

  private:
    /// Returns the bodies that may have a child, in the order of their ids.
    std::vector<std::uint32_t> candidates(Species species, const parameters::Parameters& parameters) const;
    bool is_free(Place place, float radius_px) const;
    std::optional<Place> place_beside(std::uint32_t parent, float radius_px, base::RandomStream random) const;
    void pay(std::uint32_t parent, float price) {
        const physics::Circles& bodies = island_.bodies_;
        island_.hash_ -= hash_of_organism(bodies, island_.living_, parent);
        island_.living_.health[parent] -= price;
        island_.hash_ += hash_of_organism(bodies, island_.living_, parent);
        ++island_.life_records_.children[bodies.id[parent]];
        has_child_[parent] = true;
    }

    Island& island_;
    std::uint32_t tick_;
    std::uint64_t organisms_max_; // alive or dead, in this interval
    BoxGrid boxes_;
    PlacedCircles room_;          // all living bodies, and the children
    std::vector<bool> has_child_; // by body
};

std::vector<std::uint32_t> Island::Nursery::candidates(Species species,
                                                       const parameters::Parameters& parameters) const {
    const physics::Circles& bodies = island_.bodies_;
    std::vector<std::uint32_t> found;
    for (std::uint32_t body = 0; body < bodies.size(); ++body) {
        if (!bodies.is_void(body) && island_.living_.health[body] >= static_cast<float>(parameters.birth_health) &&
            island_.species_of(bodies.id[body]) == species) {
            found.push_back(body);
        }
    }
    std::ranges::sort(found, {}, [&](std::uint32_t body) { return bodies.id[body]; });
    return found;
}

bool Island::Nursery::is_free(Place place, float radius_px) const {
    const physics::Coordinate margin = physics::to_units(radius_px);
    const physics::Area& area = island_.area_;
    const bool is_inside =
        place.x >= margin && place.x <= area.width - margin && place.y >= margin && place.y <= area.height - margin;
    return is_inside && boxes_.clear_of_circle(place, radius_px) && room_.clear(place, radius_px);
}

std::optional<Place> Island::Nursery::place_beside(std::uint32_t parent, float radius_px,
                                                   base::RandomStream random) const {
    constexpr unsigned directions = 8;
    const physics::Circles& bodies = island_.bodies_;
    const float distance = bodies.radius[parent] + radius_px + 1;
    constexpr double between = 2 * base::pi / directions;
    const unsigned first = random.below(directions);
    const double offset = random.uniform(0, between) - base::pi;
    for (unsigned k = 0; k < directions; ++k) {
        const base::Direction to = base::direction_of(static_cast<float>((first + k) % directions * between + offset));
        const Place place{bodies.x[parent] + physics::to_units(distance * to.x),
                          bodies.y[parent] + physics::to_units(distance * to.y)};
        if (is_free(place, radius_px)) {
            return place;
        }
    }
    return std::nullopt;
}

void Island::Nursery::search(Species species, const parameters::Parameters& parameters) {
    const std::vector<std::uint32_t> found = candidates(species, parameters);
    if (found.empty()) {
        return;
    }
    const auto index = static_cast<std::size_t>(species);
    const physics::Circles& bodies = island_.bodies_;
    ColonyCounts& counts = island_.colony_[index];
    const bool is_sexual = parameters.births == parameters::Births::Sexual;
    BodyGrid mates;
    if (is_sexual) {
        mates.build(bodies, found, island_.area_);
    }
    const std::uint32_t key_island = island_.index_ | static_cast<std::uint32_t>(index) << 31;
    const evolution::BreedingKey key{island_.seed_, key_island, island_.generation_ << 32 | tick_};
    const base::RandomKey place_key{key.seed, base::Purpose::BirthPlacement, key.island, key.generation};
    const base::RandomKey parents_key{key.seed, base::Purpose::BirthParents, key.island, key.generation};
    const auto gene_count = island_.born_.genes.rows();
    const std::vector<float>& latest = island_.latest_born_[index];
    const evolution::GeneMatrix pool =
        Eigen::Map<const evolution::GeneMatrix>{latest.data(), gene_count, std::ssize(latest) / gene_count};
    const bool is_shuffled = pool.cols() > 0;
    const evolution::Descent<> descent{is_shuffled ? pool : island_.born_.genes, parameters, key};
    const auto cost = static_cast<float>(parameters.birth_cost);

    std::uint32_t born = 0;
    for (const std::uint32_t body : found) {
        if (has_child_[body]) {
            continue;
        }
        std::uint32_t mate = body;
        if (is_sexual) {
            mate = mates.nearest(bodies, bodies.x[body], bodies.y[body], static_cast<float>(parameters.mate_px),
                                 [&](std::uint32_t other) { return other != body && !has_child_[other]; });
        }
        if (mate == BodyGrid::none) {
            continue;
        }
        if (counts.living + born >= parameters.population_max ||
            island_.life_records_.cause.size() + children.size() >= organisms_max_) {
            ++counts.refused;
            continue;
        }
        const auto [first, second] = std::minmax(bodies.id[body], bodies.id[mate]);
        evolution::Parents of_genes{first, second};
        if (is_shuffled) {
            base::RandomStream random{parents_key, first};
            of_genes.first = random.below(static_cast<std::uint32_t>(pool.cols()));
            of_genes.second = is_sexual ? random.below(static_cast<std::uint32_t>(pool.cols())) : of_genes.first;
        }
        std::vector<float> genes(static_cast<std::size_t>(gene_count));
        evolution::Mixture<> mixture{static_cast<unsigned>(gene_count)};
        if (is_sexual) {
            descent.draw_mixture(first, mixture);
        }
        descent.make_child(evolution::inheritance_of(of_genes, mixture.from_second), mixture, first,
                           std::span<float>{genes}, evolution::WithoutRecord{});
        const float price = cost + genes[evolution::BaseHealth] / (is_sexual ? 2.0f : 1.0f);
        if (island_.living_.health[body] - price <= 0 || island_.living_.health[mate] - price <= 0) {
            continue;
        }
        const float radius_px = body_shape(genes[evolution::BodySize], parameters).radius_px;
        const std::uint32_t first_body = bodies.id[body] == first ? body : mate;
        const auto place = place_beside(first_body, radius_px, base::RandomStream{place_key, first});
        if (!place) {
            ++counts.without_room;
            continue;
        }
        pay(body, price);
        if (mate != body) {
            pay(mate, price);
        }
        room_.add(*place, radius_px);
        children.push_back({*place, std::move(genes), tick_, {first, second}});
        ++born;
    }
    counts.born += born;
}

bool Island::births_are_due(const parameters::Parameters& parameters, std::uint32_t tick) const {
    const double every = std::max(std::round(parameters.birth_every_s / parameters.tick_s), 1.0);
    return has_births_ && tick % static_cast<std::uint32_t>(every) == 0;
}

void Island::give_birth(const parameters::Parameters& parameters, std::uint32_t tick) {
    Nursery nursery{*this, parameters, tick};
    nursery.search(Species::Prey, parameters);
    if (has_predators()) {
        nursery.search(Species::Predator, parameters::of_predators(parameters));
    }
    if (nursery.children.empty()) {
        return;
    }
    if (parameters.shuffle_births) {
        for (const NewOrganism& child : nursery.children) {
            add_to_latest(species_of(child.parents.first), child.genes);
        }
    }
    place(nursery.children, parameters);
}

void Island::add_to_latest(Species species, evolution::ConstGenes genes) {
    std::vector<float>& latest = latest_born_[static_cast<std::size_t>(species)];
    if (latest.size() == latest_births * genes.size()) {
        latest.erase(latest.begin(), latest.begin() + static_cast<std::ptrdiff_t>(genes.size()));
    }
    latest.insert(latest.end(), genes.begin(), genes.end());
}

void Island::count_living() {
    for (ColonyCounts& counts : colony_) {
        counts.living_sum += counts.living;
        counts.lowest = std::min(counts.lowest, counts.living);
    }
}

void Island::begin_colony(const parameters::Parameters& parameters, base::Executor& executor) {
    const std::uint32_t predators = born_.predator_count;
    colony_[0].living = colony_[0].first = colony_[0].lowest = bred_count() - predators;
    colony_[1].living = colony_[1].first = colony_[1].lowest = predators;
    if (opening_ != nullptr) {
        const std::array<ColonyCounts, 2> counts = colony_;
        restore(opening_->state, 0, parameters, executor);
        colony_ = counts;
        hash_ = whole_hash();
    } else if (parameters.shuffle_births) {
        for (std::uint32_t id = 0; id < bred_count(); ++id) {
            add_to_latest(species_of(id), evolution::column(born_.genes, id));
        }
    }
}

} // namespace evod::simulation
