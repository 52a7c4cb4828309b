// Rules: what organisms see, choose, eat and die of, once for every engine; the same rules as server/simulation's, in
// plain scalar code.
//
// An engine keeps the bodies, moves and collides them, and says which items lie about a place. It is a class with
//   Engine(const StartState&)
//   Vector place(i), velocity(i); void set_velocity(i, Vector)   of organism i, px and px/s
//   void push(i, Vector force)                                   until the next step, kg px/s²
//   void step()                                                  forces, damping, collisions, places of one tick
//   void items_about(Vector place, double reach, found)          found(item) for at least every item within reach
//   void move_item(item, Vector place)
//   void remove_organism(i)
//
// One tick: eaten items reappear → everyone loses health → perception and choice → step → feeding → deaths.
// Draws are evod's (base/random.h), but for where items reappear, which is as uniform but not the same place.
#pragma once

#include "server/base/elementary.h"
#include "server/base/executor.h"
#include "server/base/random.h"
#include "tests/bench/engines/scene.h"
#include "tests/bench/engines/start_state.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace evod::bench {

template <class Engine>
class EngineScene {
  public:
    EngineScene(const StartState& start, base::Seed seed)
        : model_{start.model}
        , width_{start.width}
        , height_{start.height}
        , food_count_{start.food_count}
        , engine_{start}
        , organisms_{start.organisms}
        , items_{start.items}
        , behaviour_key_{seed, base::Purpose::Behaviour, 0, 1}
        , respawn_key_{seed, base::Purpose::FoodRespawn, 0, 1}
        , perceived_(organisms_.size())
        , takers_(items_.size(), no_taker) {
        for (std::uint32_t i = 0; i < organisms_.size(); ++i) {
            living_.push_back(i);
        }
    }

    std::uint64_t alive_count() const { return living_.size(); }
    const Counts& counts() const { return counts_; }

    void advance_tick(base::Executor&) {
        ++tick_;
        reappear();
        for (const std::uint32_t i : living_) {
            organisms_[i].health -= model_.health_loss;
            engine_.push(i, choose(i));
        }
        engine_.step();
        limit_speeds();
        feed();
        bury_the_dead();
    }

    Observation observation() const {
        Observation observation;
        for (const std::uint32_t i : living_) {
            observation.organisms.push_back({engine_.place(i), engine_.velocity(i), organisms_[i].food_radius});
        }
        observation.food.assign(items_.begin(), items_.begin() + static_cast<std::ptrdiff_t>(food_count_));
        for (const std::uint32_t item : eaten_) {
            if (item < food_count_) {
                observation.food[item].x = -1e9; // is away until the next tick
            }
        }
        return observation;
    }

  private:
    /// The nearest item of a kind that is seen: its square distance and the way to it.
    struct Nearest {
        double square;
        Vector way;
        bool seen = false;

        void observe(const Vector& to_item) {
            const double distance = bench::square(to_item);
            if (distance < square || (!seen && distance == square)) {
                square = distance;
                way = to_item;
                seen = true;
            }
        }
    };
    /// Where an organism was at the tick's start, and a distance that no item was nearer than.
    struct Perception {
        Vector place;
        double clear;
    };
    struct Taker {
        double square; // of the distance, px²
        std::uint32_t organism;
    };
    static constexpr Taker no_taker{std::numeric_limits<double>::infinity(), std::numeric_limits<std::uint32_t>::max()};

    bool is_food(std::uint32_t item) const { return item < food_count_; }

    void reappear() {
        for (const std::uint32_t item : eaten_) {
            const auto words = respawn_key_.words(item, tick_, 0);
            const auto anywhere = [&](std::uint32_t word, double size) {
                return model_.item_radius + (size - 2 * model_.item_radius) * 0x1p-32 * word;
            };
            items_[item] = {anywhere(words[0], width_), anywhere(words[1], height_)};
            engine_.move_item(item, items_[item]);
        }
        eaten_.clear();
    }

    Vector along(const Vector& way, double size, std::uint32_t i) const {
        const double length = std::sqrt(square(way));
        if (length == 0) {
            const base::Direction random = base::direction(behaviour_key_.words(i, tick_, 0)[0]);
            return {static_cast<double>(random.x) * size, static_cast<double>(random.y) * size};
        }
        return {way.x * size / length, way.y * size / length};
    }

    /// The force with which organism i answers what it sees.
    Vector choose(std::uint32_t i) {
        const Born& organism = organisms_[i];
        const Vector place = engine_.place(i);
        Nearest food{.square = organism.food_radius * organism.food_radius, .way = {}};
        Nearest poison{.square = organism.poison_radius * organism.poison_radius, .way = {}};
        engine_.items_about(place, std::max(organism.food_radius, organism.poison_radius), [&](std::uint32_t item) {
            const Vector way{items_[item].x - place.x, items_[item].y - place.y};
            (is_food(item) ? food : poison).observe(way);
        });
        perceived_[i] = {place, std::sqrt(std::min(food.square, poison.square))};

        const double effort = organism.impulse * model_.force_per_unit;
        const bool afraid = poison.seen && (!food.seen || poison.square < food.square);
        if (afraid &&
            static_cast<double>(base::unit_float(behaviour_key_.words(i, tick_, 0)[1])) * model_.certain_impulse <
                organism.impulse) {
            return along({-poison.way.x, -poison.way.y}, effort, i);
        }
        if (!food.seen) {
            return along({}, organism.normal_speed * model_.force_per_unit, i);
        }
        const Vector velocity = engine_.velocity(i);
        return along({food.way.x - velocity.x * model_.lookahead_s, food.way.y - velocity.y * model_.lookahead_s},
                     effort, i);
    }

    void limit_speeds() {
        for (const std::uint32_t i : living_) {
            const Vector velocity = engine_.velocity(i);
            const double speed = square(velocity);
            if (speed > model_.max_speed * model_.max_speed) {
                const double share = model_.max_speed / std::sqrt(speed);
                engine_.set_velocity(i, {velocity.x * share, velocity.y * share});
            }
        }
    }

    void feed() {
        for (const std::uint32_t i : living_) {
            const Vector place = engine_.place(i);
            const double reach = organisms_[i].radius + model_.item_radius;
            // Items rest: what was further away than the reach and the way since cannot be touched.
            const Vector moved{place.x - perceived_[i].place.x, place.y - perceived_[i].place.y};
            if (perceived_[i].clear > reach + std::sqrt(square(moved))) {
                continue;
            }
            engine_.items_about(place, reach, [&](std::uint32_t item) {
                const double distance = square({items_[item].x - place.x, items_[item].y - place.y});
                Taker& taker = takers_[item];
                if (distance > reach * reach) {
                    return;
                }
                if (taker.organism == no_taker.organism) {
                    eaten_.push_back(item);
                }
                if (distance < taker.square) {
                    taker = {distance, i};
                }
            });
        }
        for (const std::uint32_t item : eaten_) {
            double& health = organisms_[takers_[item].organism].health;
            health += is_food(item) ? model_.food_health : -model_.poison_harm;
            ++(is_food(item) ? counts_.food_eaten : counts_.poison_eaten);
            takers_[item] = no_taker;
        }
    }

    void bury_the_dead() {
        std::erase_if(living_, [&](std::uint32_t i) {
            if (organisms_[i].health > 0) {
                return false;
            }
            engine_.remove_organism(i);
            ++counts_.deaths;
            return true;
        });
    }

    Model model_;
    double width_, height_;
    std::size_t food_count_;
    Engine engine_;
    std::vector<Born> organisms_; // health is the present one
    std::vector<Vector> items_;   // food, then poison
    base::RandomKey behaviour_key_, respawn_key_;
    std::uint64_t tick_ = 0;
    std::vector<std::uint32_t> living_; // in order of id
    std::vector<Perception> perceived_;
    std::vector<Taker> takers_;
    std::vector<std::uint32_t> eaten_; // in this tick
    Counts counts_;
};

} // namespace evod::bench
