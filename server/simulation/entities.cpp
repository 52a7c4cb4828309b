#include "server/simulation/entities.h"

#include "server/base/assert.h"
#include "server/simulation/place_grid.h"
#include "server/simulation/placement.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <utility>

namespace evod::simulation {
namespace {

using base::Refusal;
using base::RefusalCode;
using base::Result;
using base::Violation;
using Violations = std::vector<Violation>;

std::string text_of(double number) {
    return parameters::to_text(parameters::ParameterValue{number});
}
std::string text_of(double x, double y) {
    return text_of(x) + ", " + text_of(y);
}

std::string entry(const char* list, std::size_t index) {
    return list + ("[" + std::to_string(index) + "]");
}

/// Returns why a world cannot be changed by this command at all; nullopt if it can.
std::optional<Refusal> refusal_of(const World& world, std::uint32_t island, const char* field) {
    const auto refused = [](const char* why, base::Reason reason) {
        return refusal(RefusalCode::FailedPrecondition, why, reason);
    };
    if (island >= world.island_count()) {
        return Refusal{
            .code = RefusalCode::NotFound,
            .message = "no such island",
            .violations = {{field, "0 to " + std::to_string(world.island_count() - 1), std::to_string(island)}},
            .reason = base::Reason::IslandNotFound};
    }
    if (!world.has_bodies()) {
        return refused("the fitness of this world depends only on the chromosome: its islands contain no items or "
                       "bodies; set fitness to life, or external_bodies to true, and reset the world",
                       base::Reason::NoBodies);
    }
    if (world.is_after_last_tick()) {
        return refused("the generation is over, and the next one begins with the next tick: run one tick first",
                       base::Reason::GenerationOver);
    }
    return std::nullopt;
}

Result<void> refused_if(Violations violations, const char* message) {
    if (violations.empty()) {
        return {};
    }
    violations.resize(std::min(violations.size(), faults_max));
    return Refusal{.code = RefusalCode::InvalidArgument, .message = message, .violations = std::move(violations)};
}

/// Tests places on an island as it is now.
class PlaceCheck {
  public:
    PlaceCheck(const Island& island, std::size_t organisms)
        : island_{island}, boxes_{island.area(), island.boxes()}, new_organisms_{island.area(), organisms} {}

    /// Returns the place; nullopt, with violations added, if a circle cannot be there.
    std::optional<Place> place_of(const std::string& name, double x_px, double y_px, float radius_px,
                                  Violations& violations) const {
        const bool is_inside = in_walls(name + ".x_px", x_px, radius_px, island_.area().width, violations) &
                               in_walls(name + ".y_px", y_px, radius_px, island_.area().height, violations);
        if (!is_inside) {
            return std::nullopt;
        }
        const Place place{physics::to_units(x_px), physics::to_units(y_px)};
        if (!boxes_.clear_of_circle(place, radius_px)) {
            violations.push_back({name, "a place clear of crates and obstacles", text_of(x_px, y_px)});
            return std::nullopt;
        }
        return place;
    }

    /// Adds an organism that will be placed; a violation if it overlaps one that was added before.
    void add(std::size_t index, Place place, float radius_px, Violations& violations) {
        widest_px_ = std::max(widest_px_, radius_px);
        std::uint32_t other = none;
        (void)new_organisms_.any_near(place, reach(radius_px), [&](Place at, const NewCircle& circle) {
            const bool touch = touching(place, radius_px, at, circle.radius_px);
            other = touch ? std::min(other, circle.index) : other;
            return touch;
        });
        if (other != none) {
            violations.push_back({entry("place.organisms", index),
                                  "a place clear of " + entry("place.organisms", other),
                                  text_of(physics::to_px(place.x), physics::to_px(place.y))});
        }
        new_organisms_.add(place, {radius_px, static_cast<std::uint32_t>(index)});
        places_.push_back({place, index});
    }

    /// Adds violations for the added organisms that overlap living ones.
    void check_living(Violations& violations) const {
        if (places_.empty()) {
            return;
        }
        const physics::Circles& bodies = island_.bodies();
        std::vector<std::uint32_t> overlapped(places_.back().index + 1, none); // the lowest id, by index in the command
        for (std::size_t i = 0; i < bodies.size(); ++i) {
            if (bodies.is_void(i)) {
                continue;
            }
            const Place body{bodies.x[i], bodies.y[i]};
            (void)new_organisms_.any_near(body, reach(bodies.radius[i]), [&](Place at, const NewCircle& circle) {
                if (touching(body, bodies.radius[i], at, circle.radius_px)) {
                    overlapped[circle.index] = std::min(overlapped[circle.index], bodies.id[i]);
                }
                return false; // visits every circle
            });
        }
        for (const auto& [place, index] : places_) {
            if (overlapped[index] != none) {
                violations.push_back(
                    {entry("place.organisms", index),
                     "a place clear of organisms (organism " + std::to_string(overlapped[index]) + " is there)",
                     text_of(physics::to_px(place.x), physics::to_px(place.y))});
            }
        }
    }

  private:
    static constexpr std::uint32_t none = ~0U;
    struct NewCircle {
        float radius_px;
        std::uint32_t index;
    };

    static bool in_walls(const std::string& field, double px, float radius_px, physics::Coordinate size,
                         Violations& violations) {
        const physics::Coordinate margin = physics::to_units(radius_px);
        const double least = physics::to_px(margin), most = physics::to_px(size - margin);
        if (px >= least && px <= most) { // a NaN is in no range
            return true;
        }
        violations.push_back({field, text_of(least) + " to " + text_of(most), text_of(px)});
        return false;
    }
    static bool touching(Place a, float radius_a, Place b, float radius_b) {
        const float dx = physics::distance_px(a.x, b.x), dy = physics::distance_px(a.y, b.y),
                    touch = radius_a + radius_b;
        return dx * dx + dy * dy <= touch * touch;
    }
    /// The greatest distance, along either axis, between a circle and an added one that it touches; a few units more,
    /// because the test rounds.
    physics::Coordinate reach(float radius_px) const { return physics::to_units(radius_px + widest_px_) + 2; }

    const Island& island_;
    BoxGrid boxes_;
    PlaceGrid<NewCircle> new_organisms_;
    float widest_px_ = 0; // radius of the widest added organism
    struct Added {
        Place place;
        std::size_t index;
    };
    std::vector<Added> places_;
};

/// Returns why an island cannot get this many more placed entities; nullopt if it can.
std::optional<Refusal> refusal_of_counts(const Island& island, const PlaceEntities& command) {
    const auto food =
        static_cast<std::size_t>(std::ranges::count(command.items, ItemKind::Food, &PlaceEntities::Item::kind));
    const auto is_too_many = [](std::size_t placed, std::size_t more) { return placed + more > placed_max; };
    const auto placed_of = [](const Items& items) { return std::size_t{items.size() - items.first_count()}; };
    const std::size_t organisms = island.life_records().cause.size() - island.bred_count();
    if (is_too_many(placed_of(island.food()), food) ||
        is_too_many(placed_of(island.poison()), command.items.size() - food) ||
        is_too_many(organisms, command.organisms.size())) {
        const std::size_t placed_most = std::max({placed_of(island.food()), placed_of(island.poison()), organisms});
        return base::limit_refusal(
            "an island gets at most " + std::to_string(placed_max) +
                " placed food items, poison items and organisms each in one generation: wait for the next generation",
            base::Reason::PlacedMax, "placed_max", placed_most, placed_max);
    }
    return std::nullopt;
}

/// Adds a violation for every id that exists twice or of which `exists` is false.
template <class Exists>
void check_ids(const char* list, const char* allowed, std::span<const std::uint32_t> ids, Exists&& exists,
               Violations& violations) {
    std::set<std::uint32_t> seen;
    for (std::size_t i = 0; i < ids.size(); ++i) {
        const char* expected = !exists(ids[i]) ? allowed : seen.insert(ids[i]).second ? nullptr : "each id once";
        if (expected != nullptr) {
            violations.push_back({entry(list, i), expected, std::to_string(ids[i])});
        }
    }
}

} // namespace

Result<void> check(const World& world, const PlaceEntities& command) {
    if (auto refused = refusal_of(world, command.island, "place.island")) {
        return *refused;
    }
    const Island& island = world.island(command.island);
    if (auto refused = refusal_of_counts(island, command)) {
        return *refused;
    }
    const parameters::Parameters& parameters = world.parameters().active;
    const evolution::GeneLayout layout = evolution::gene_layout(parameters);
    const evolution::FreeGeneOperators listed{parameters};
    Violations violations;
    PlaceCheck places{island, command.organisms.size()};
    for (std::size_t i = 0; i < command.items.size(); ++i) {
        const PlaceEntities::Item& item = command.items[i];
        (void)places.place_of(entry("place.items", i), item.x_px, item.y_px, island.food().radius_px(), violations);
    }
    for (std::size_t i = 0; i < command.organisms.size(); ++i) {
        const PlaceEntities::Organism& organism = command.organisms[i];
        const std::string name = entry("place.organisms", i);
        const std::size_t faults = violations.size();
        add_gene_faults(organism.genes, layout, listed, name, violations);
        if (violations.size() > faults) {
            continue; // without valid genes, the radius is unknown
        }
        const float radius_px = body_shape(organism.genes[evolution::BodySize], parameters).radius_px;
        if (const auto place = places.place_of(name, organism.x_px, organism.y_px, radius_px, violations)) {
            places.add(i, *place, radius_px, violations);
        }
    }
    places.check_living(violations);
    return refused_if(std::move(violations), "cannot place these items and organisms; nothing was placed");
}

Result<void> check(const World& world, const RemoveEntities& command) {
    if (auto refused = refusal_of(world, command.island, "remove.island")) {
        return *refused;
    }
    if (command.generation && *command.generation != world.moment().generation) {
        return Refusal{.code = RefusalCode::Aborted,
                       .message = "the ids belong to a generation that is not the current one",
                       .violations = {{"remove.generation", std::to_string(world.moment().generation),
                                       std::to_string(*command.generation)}},
                       .reason = base::Reason::GenerationChanged,
                       .arguments = {{"expected_generation", std::to_string(*command.generation)},
                                     {"generation", std::to_string(world.moment().generation)}}};
    }
    const Island& island = world.island(command.island);
    const auto is_present = [](const Items& items) {
        return [&items](std::uint32_t item) { return item < items.size() && items.present(item); };
    };
    Violations violations;
    check_ids("remove.food", "the id of food that is present", command.food, is_present(island.food()), violations);
    check_ids("remove.poison", "the id of poison that is present", command.poison, is_present(island.poison()),
              violations);
    check_ids(
        "remove.organisms", "the id of a living organism", command.organisms,
        [&](std::uint32_t id) { return island.body_of(id).has_value(); }, violations);
    return refused_if(std::move(violations), "cannot remove these items and organisms; nothing was removed");
}

std::uint32_t Island::place(ItemKind kind, Place place) {
    Items& of_kind = items(kind);
    hash_ -= of_kind.hash();
    const std::uint32_t item = of_kind.add(place);
    hash_ += of_kind.hash();
    return item;
}

void Island::remove(ItemKind kind, std::uint32_t item) {
    Items& of_kind = items(kind);
    hash_ -= of_kind.hash();
    of_kind.remove(item);
    hash_ += of_kind.hash();
}

std::uint32_t Island::place(std::span<const NewOrganism> organisms, const parameters::Parameters& parameters) {
    EVOD_ASSERT(has_bodies());
    const auto first = static_cast<std::uint32_t>(life_records_.cause.size());
    append(organisms, parameters);
    for (std::uint32_t id = first; id < life_records_.cause.size(); ++id) {
        hash_ += hash_of_birth(id);
        hash_ += hash_of_organism(bodies_, living_, body_of_[id]);
    }
    perception_.append(bodies_, living_, food_, poison_, bodies_.size() - organisms.size());
    stepper_.near().invalidate();
    return first;
}

void Island::append(std::span<const NewOrganism> organisms, const parameters::Parameters& parameters) {
    const std::size_t bodies = bodies_.size();
    const Eigen::Index first = born_.genes.cols();
    const parameters::Parameters of_predators = parameters::of_predators(parameters);
    std::vector<Arrival> arrivals;
    for (const NewOrganism& organism : organisms) {
        const std::uint32_t parent = organism.parents.first;
        const bool is_new =
            parent >= static_cast<std::uint32_t>(first); // restore() appends the children of children at once
        const bool is_predator =
            parent != no_parents.first && (is_new ? arrivals[parent - static_cast<std::uint32_t>(first)].is_predator
                                                  : species_of(parent) == Species::Predator);
        arrivals.push_back({organism.tick, organism.parents, is_predator});
    }
    born_.genes.conservativeResize(Eigen::NoChange, first + std::ssize(organisms));
    arrivals_.insert(arrivals_.end(), arrivals.begin(), arrivals.end());
    bodies_.resize(bodies + organisms.size());
    living_.resize(bodies + organisms.size());
    for (std::size_t i = 0; i < organisms.size(); ++i) {
        const NewOrganism& organism = organisms[i];
        const auto id = static_cast<std::uint32_t>(first) + static_cast<std::uint32_t>(i);
        const BodyShape shape = body_shape(organism.genes[evolution::BodySize], parameters);
        std::ranges::copy(organism.genes, evolution::column(born_.genes, id).begin());
        if (!born_.parents.empty()) {
            born_.parents.push_back(organism.parents);
        }
        life_records_.add(is_colony());
        body_of_.push_back(static_cast<std::uint32_t>(bodies + i));
        bodies_.put(
            bodies + i,
            {.id = id, .x = organism.place.x, .y = organism.place.y, .radius = shape.radius_px, .mass = shape.mass_kg});
        const bool is_predator = species_of(id) == Species::Predator;
        put_living(bodies + i, id, is_predator ? of_predators : parameters);
        if (is_colony()) {
            ++colony_[is_predator ? 1 : 0].living;
        }
        born_hash_ += hash_of_birth(id);
    }
    hunt_.forget();
    alive_count_ += static_cast<std::uint32_t>(organisms.size());
}

void Island::remove_organism(std::uint32_t id, std::uint32_t tick) {
    const std::uint32_t body = body_of_[id];
    EVOD_ASSERT(body != no_body);
    hash_ -= hash_of_organism(bodies_, living_, body);
    life_records_.cause[id] = CauseOfDeath::Removed;
    life_records_.lived_ticks[id] = tick - placed_tick(id);
    body_of_[id] = no_body;
    bodies_.remove(body);
    perception_.remove(body);
    stepper_.near().invalidate();
    living_.health[body] = -std::numeric_limits<float>::infinity();
    --alive_count_;
    if (is_colony()) {
        --colony_[static_cast<std::size_t>(species_of(id))].living;
    }
}

evolution::NextGeneration Island::bred() const {
    evolution::NextGeneration bred = born_;
    bred.genes.conservativeResize(Eigen::NoChange, bred_count());
    if (!bred.parents.empty()) {
        bred.parents.resize(bred_count());
    }
    return bred;
}

bool Island::is_as_begun() const {
    const auto all_present = [](const Items& items) {
        return items.size() == items.first_count() && items.present_count() == items.size();
    };
    if (opening_ != nullptr) {
        const auto is_same = [](const Items& items, const base::Column<Items::Item>& begun) {
            return items.size() == begun.size() && std::ranges::equal(items.all(), begun);
        };
        return arrivals_.empty() && alive_count_ == bred_count() && is_same(food_, opening_->state.food) &&
               is_same(poison_, opening_->state.poison);
    }
    return arrivals_.empty() &&
           (!has_bodies() || (alive_count_ == bred_count() && all_present(food_) && all_present(poison_)));
}

} // namespace evod::simulation
