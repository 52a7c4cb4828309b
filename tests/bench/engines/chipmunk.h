// Chipmunk 7 as an engine, with its cheapest sensible settings: one iteration of the solver, no rotation, items as
// offset shapes of the static body that collide with nothing.
//
// Chipmunk moves bodies before it adds a tick's forces to the velocities; so that organisms answer in the same tick as
// elsewhere, their forces are given as impulses.
// Source  the headers of Chipmunk 7.0.3; cell size and count of the hash tried for this density: 200 px, 8 cells an
// organism.
#pragma once

#include "tests/bench/engines/start_state.h"

#include <chipmunk/chipmunk.h>
#include <chipmunk/chipmunk_unsafe.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

namespace evod::bench {

enum class ChipmunkIndex { Tree, Hash };

template <ChipmunkIndex index>
class Chipmunk {
  public:
    explicit Chipmunk(const StartState& start) : tick_s_{start.model.tick_s}, space_{cpSpaceNew()} {
        cpSpaceSetIterations(space_.get(), 1);
        // Overlap is removed at once, as in the model; with the defaults 1 % less is eaten.
        cpSpaceSetCollisionSlop(space_.get(), 0);
        cpSpaceSetCollisionBias(space_.get(), 0);
        cpSpaceSetDamping(space_.get(), std::pow(start.model.damping, 1 / tick_s_));
        if (index == ChipmunkIndex::Hash) {
            cpSpaceUseSpatialHash(space_.get(), 200, static_cast<int>(8 * start.organisms.size()));
        }
        cpBody* ground = cpSpaceGetStaticBody(space_.get());
        for (const Vector& place : start.items) {
            cpShape* shape = add(cpCircleShapeNew(ground, start.model.item_radius, cpv(place.x, place.y)), items);
            cpShapeSetUserData(shape, reinterpret_cast<void*>(item_shapes_.size()));
            item_shapes_.push_back(shape);
        }
        // Elasticities are multiplied.
        const double elasticity = std::sqrt(start.model.restitution);
        for (const Born& born : start.organisms) {
            cpBody* body = bodies_.emplace_back(cpBodyNew(born.mass, INFINITY)).get();
            cpBodySetPosition(body, cpv(born.place.x, born.place.y));
            cpSpaceAddBody(space_.get(), body);
            cpShape* shape = add(cpCircleShapeNew(body, born.radius, cpvzero), organisms);
            cpShapeSetElasticity(shape, elasticity);
            organism_shapes_.push_back(shape);
        }
        constexpr double thickness = 50;
        const double left = -thickness, right = start.width + thickness, top = -thickness,
                     bottom = start.height + thickness;
        const cpVect corners[] = {{left, top}, {right, top}, {right, bottom}, {left, bottom}};
        for (int side = 0; side < 4; ++side) {
            cpShapeSetElasticity(
                add(cpSegmentShapeNew(ground, corners[side], corners[(side + 1) % 4], thickness), organisms),
                elasticity);
        }
    }

    Vector place(std::uint32_t i) const { return vector(cpBodyGetPosition(bodies_[i].get())); }
    Vector velocity(std::uint32_t i) const { return vector(cpBodyGetVelocity(bodies_[i].get())); }
    void set_velocity(std::uint32_t i, const Vector& velocity) {
        cpBodySetVelocity(bodies_[i].get(), cpv(velocity.x, velocity.y));
    }
    void push(std::uint32_t i, const Vector& force) {
        cpBodyApplyImpulseAtLocalPoint(bodies_[i].get(), cpv(force.x * tick_s_, force.y * tick_s_), cpvzero);
    }
    void step() { cpSpaceStep(space_.get(), tick_s_); }

    template <class Found>
    void items_about(const Vector& place, double reach, Found&& found) const {
        const auto call = [](cpShape* shape, void* data) {
            (*static_cast<Found*>(data))(
                static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(cpShapeGetUserData(shape))));
        };
        cpSpaceBBQuery(space_.get(), cpBBNewForCircle(cpv(place.x, place.y), reach), items, call, &found);
    }

    void move_item(std::uint32_t item, const Vector& place) {
        cpCircleShapeSetOffset(item_shapes_[item], cpv(place.x, place.y));
        cpSpaceReindexShape(space_.get(), item_shapes_[item]);
    }

    void remove_organism(std::uint32_t i) {
        cpSpaceRemoveShape(space_.get(), organism_shapes_[i]);
        cpSpaceRemoveBody(space_.get(), bodies_[i].get());
    }

  private:
    // Two shapes meet if each has the category of the other in its mask.
    static constexpr cpShapeFilter organisms{.group = 0, .categories = 1, .mask = 1};
    static constexpr cpShapeFilter items{.group = 0, .categories = 2, .mask = 2};

    struct Free {
        void operator()(cpSpace* space) const { cpSpaceFree(space); }
        void operator()(cpBody* body) const { cpBodyFree(body); }
        void operator()(cpShape* shape) const { cpShapeFree(shape); }
    };

    static Vector vector(cpVect v) { return {v.x, v.y}; }

    cpShape* add(cpShape* shape, const cpShapeFilter& filter) {
        cpShapeSetFilter(shape, filter);
        shapes_.emplace_back(shape);
        return cpSpaceAddShape(space_.get(), shape);
    }

    double tick_s_;
    std::vector<std::unique_ptr<cpShape, Free>> shapes_; // all of them; freed after the space
    std::vector<std::unique_ptr<cpBody, Free>> bodies_;  // by organism
    std::unique_ptr<cpSpace, Free> space_;
    std::vector<cpShape*> item_shapes_, organism_shapes_;
};

} // namespace evod::bench
