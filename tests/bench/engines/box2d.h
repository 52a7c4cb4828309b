// Box2D 2.4 as an engine, with its cheapest sensible settings: one iteration of each solver, no sleep, no continuous
// collision, no rotation, items as static fixtures whose filter makes no contacts.
//
// Source  the headers of Box2D 2.4.1. Lengths are 0.05 m a pixel, so that bodies have the sizes it is made for.
#pragma once

#include "tests/bench/engines/start_state.h"

#include <box2d/box2d.h>

#include <cstdint>
#include <memory>
#include <vector>

namespace evod::bench {

class Box2d {
  public:
    explicit Box2d(const StartState& start)
        : tick_s_{static_cast<float>(start.model.tick_s)}
        , item_radius_{start.model.item_radius}
        , world_{std::make_unique<b2World>(b2Vec2_zero)} {
        world_->SetAllowSleeping(false);
        world_->SetContinuousPhysics(false);
        world_->SetWarmStarting(false);
        for (std::uint32_t item = 0; item < start.items.size(); ++item) {
            // A fixture is removed by a search among its body's, but every body costs time in every step.
            if (item % items_per_body == 0) {
                const b2BodyDef at_origin;
                item_bodies_.push_back(world_->CreateBody(&at_origin));
            }
            item_fixtures_.push_back(put_item(item, start.items[item]));
        }
        // v ← v / (1 + tick · damping)
        const auto damping = static_cast<float>((1 / start.model.damping - 1) / start.model.tick_s);
        for (const Born& born : start.organisms) {
            b2BodyDef definition;
            definition.type = b2_dynamicBody;
            definition.position = metres(born.place);
            definition.linearDamping = damping;
            definition.fixedRotation = true;
            b2CircleShape circle;
            circle.m_radius = metres(born.radius);
            b2FixtureDef fixture = bouncing(circle, start.model);
            fixture.density = static_cast<float>(born.mass) / (b2_pi * circle.m_radius * circle.m_radius);
            bodies_.push_back(world_->CreateBody(&definition));
            bodies_.back()->CreateFixture(&fixture);
        }
        add_walls(start);
    }

    Vector place(std::uint32_t i) const { return pixels(bodies_[i]->GetPosition()); }
    Vector velocity(std::uint32_t i) const { return pixels(bodies_[i]->GetLinearVelocity()); }
    void set_velocity(std::uint32_t i, const Vector& velocity) { bodies_[i]->SetLinearVelocity(metres(velocity)); }
    void push(std::uint32_t i, const Vector& force) { bodies_[i]->ApplyForceToCenter(metres(force), true); }
    void step() { world_->Step(tick_s_, 1, 1); }

    template <class Found>
    void items_about(const Vector& place, double reach, Found&& found) const {
        struct Query final : b2QueryCallback {
            explicit Query(Found& call) : call_{call} {}
            bool ReportFixture(b2Fixture* fixture) override {
                if (const std::uintptr_t number = fixture->GetUserData().pointer; number != 0) {
                    call_(static_cast<std::uint32_t>(number - 1));
                }
                return true;
            }
            Found& call_;
        } query{found};
        b2AABB box;
        box.lowerBound = metres(Vector{place.x - reach, place.y - reach});
        box.upperBound = metres(Vector{place.x + reach, place.y + reach});
        world_->QueryAABB(&query, box);
    }

    void move_item(std::uint32_t item, const Vector& place) {
        item_bodies_[item / items_per_body]->DestroyFixture(item_fixtures_[item]);
        item_fixtures_[item] = put_item(item, place);
    }

    void remove_organism(std::uint32_t i) { world_->DestroyBody(bodies_[i]); }

  private:
    static constexpr double metres_per_px = 0.05;
    static constexpr std::uint32_t items_per_body = 32;

    static float metres(double px) { return static_cast<float>(px * metres_per_px); }
    static b2Vec2 metres(const Vector& v) { return {metres(v.x), metres(v.y)}; }
    static Vector pixels(const b2Vec2& v) {
        return {static_cast<double>(v.x) / metres_per_px, static_cast<double>(v.y) / metres_per_px};
    }

    /// Restitutions and frictions of two fixtures are mixed as the greater and the geometric mean.
    static b2FixtureDef bouncing(const b2Shape& shape, const Model& model) {
        b2FixtureDef fixture;
        fixture.shape = &shape;
        fixture.friction = 0;
        fixture.restitution = static_cast<float>(model.restitution);
        fixture.restitutionThreshold = 0;
        return fixture;
    }

    b2Fixture* put_item(std::uint32_t item, const Vector& place) {
        b2CircleShape circle;
        circle.m_p = metres(place);
        circle.m_radius = metres(item_radius_);
        b2FixtureDef fixture;
        fixture.shape = &circle;
        fixture.filter.maskBits = 0;
        fixture.userData.pointer = item + 1; // 0: no item
        return item_bodies_[item / items_per_body]->CreateFixture(&fixture);
    }

    void add_walls(const StartState& start) {
        constexpr double half = 50; // of their thickness, px
        const b2BodyDef at_origin;
        b2Body* ground = world_->CreateBody(&at_origin);
        const auto wall = [&](double x, double y, double half_width, double half_height) {
            b2PolygonShape box;
            box.SetAsBox(metres(half_width), metres(half_height), metres(Vector{x, y}), 0);
            const b2FixtureDef fixture = bouncing(box, start.model);
            ground->CreateFixture(&fixture);
        };
        const double middle_x = start.width / 2, middle_y = start.height / 2;
        wall(middle_x, -half, middle_x + 2 * half, half);
        wall(middle_x, start.height + half, middle_x + 2 * half, half);
        wall(-half, middle_y, half, middle_y + 2 * half);
        wall(start.width + half, middle_y, half, middle_y + 2 * half);
    }

    float tick_s_;
    double item_radius_;
    std::unique_ptr<b2World> world_; // owns every body and fixture
    std::vector<b2Body*> item_bodies_;
    std::vector<b2Fixture*> item_fixtures_; // by item
    std::vector<b2Body*> bodies_;           // by organism
};

} // namespace evod::bench
