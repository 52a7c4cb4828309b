// Crowds: circles, crates and obstacles cover half of the area, and all of them touch others all the time.
#include "server/physics/shapes.h"
#include "server/jobs/thread_pool.h"
#include "tests/unit/physics/test_bodies.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <span>
#include <vector>

namespace evod::physics {
namespace {

constexpr double side = 1500;

TestBodies crowd(double share, std::uint64_t seed) {
    TestBodies setup;
    setup.area = {to_units(side), to_units(side)};
    setup.parameters.integration = integration(Integrator::SymplecticEuler, 1.0 / 60, damping_rate(0.999));
    base::RandomStream random = test_stream(seed);
    const auto place = [&] { return random.uniform(12, side - 12); };
    double covered = 0;
    while (covered < share * side * side) {
        const float radius = uniform_float(random, 8, 12);
        covered += 3.14159 * static_cast<double>(radius * radius);
        const double x = place(), y = place();
        const float vx = uniform_float(random, -200, 200);
        setup.add_circle(x, y, radius, radius / 10, vx, uniform_float(random, -200, 200));
    }
    for (int i = 0; i < 30; ++i) {
        const double x = place(), y = place();
        setup.add_box(x, y, 20, 15, i < 20 ? 0.25f : 0.0f);
    }
    return setup;
}

struct Motion {
    double x = 0, y = 0, size = 0, energy = 0;
};

/// Sums over movable bodies: momentum, its magnitude, kinetic energy.
Motion motion_of(const TestBodies& setup) {
    Motion sum;
    const auto add = [&](const Bodies& bodies) {
        for (std::size_t i = 0; i < bodies.x.size(); ++i) {
            if (bodies.inverse_mass[i] > 0) {
                const double mass = 1 / static_cast<double>(bodies.inverse_mass[i]);
                const auto vx = static_cast<double>(bodies.velocity_x[i]),
                           vy = static_cast<double>(bodies.velocity_y[i]);
                sum.x += mass * vx;
                sum.y += mass * vy;
                sum.size += mass * std::hypot(vx, vy);
                sum.energy += mass * (vx * vx + vy * vy) / 2;
            }
        }
    };
    add(setup.circles);
    add(setup.boxes);
    return sum;
}

/// The momentum that walls give to the bodies that touch them or are beyond them, and move outward.
Motion impulse_of_walls(const TestBodies& setup, bool beyond_only) {
    Motion impulse;
    const auto along = [&](double& sum, Coordinate position, double velocity, Coordinate extent, Coordinate size,
                           double mass) {
        const bool at_low = beyond_only ? position < extent : position <= extent;
        const bool at_high = beyond_only ? position > size - extent : position >= size - extent;
        if ((at_low && velocity < 0) || (at_high && velocity > 0)) {
            sum -= mass * velocity * (1 + static_cast<double>(setup.parameters.restitution));
        }
    };
    const auto add = [&](const Bodies& bodies, std::size_t i, Coordinate extent_x, Coordinate extent_y) {
        const double mass = 1 / static_cast<double>(bodies.inverse_mass[i]);
        along(impulse.x, bodies.x[i], static_cast<double>(bodies.velocity_x[i]), extent_x, setup.area.width, mass);
        along(impulse.y, bodies.y[i], static_cast<double>(bodies.velocity_y[i]), extent_y, setup.area.height, mass);
    };
    for (std::size_t i = 0; i < setup.circles.size(); ++i) {
        add(setup.circles, i, to_units(setup.circles.radius[i]), to_units(setup.circles.radius[i]));
    }
    for (std::size_t i = 0; i < setup.boxes.size(); ++i) {
        if (setup.boxes.inverse_mass[i] > 0) {
            add(setup.boxes, i, to_units(setup.boxes.half_width[i]), to_units(setup.boxes.half_height[i]));
        }
    }
    return impulse;
}

/// The greatest overlap of two circles, as a share of the smaller radius.
double deepest_overlap(const TestBodies& setup) {
    const Circles& circles = setup.circles;
    double deepest = 0;
    for (std::size_t a = 0; a < circles.size(); ++a) {
        for (std::size_t b = a + 1; b < circles.size(); ++b) {
            if (std::abs(circles.x[a] - circles.x[b]) > to_units(24.0f)) {
                continue;
            }
            const Overlap overlap =
                circle_circle(distance_px(circles.x[a], circles.x[b]), distance_px(circles.y[a], circles.y[b]),
                              circles.radius[a], circles.radius[b]);
            deepest =
                std::max(deepest, static_cast<double>(overlap.depth / std::min(circles.radius[a], circles.radius[b])));
        }
    }
    return deepest;
}

void step_in_parts(TestBodies& setup, base::Executor& executor, const std::function<void()>& before_collisions,
                   const std::function<void()>& after_collisions) {
    Stepper& stepper = setup.stepper;
    const std::vector<float> none(circles_per_block, 0);
    if (stepper.near().stale(setup.circles, setup.boxes)) {
        stepper.near().renew(setup.circles, setup.boxes, setup.area, executor);
    }
    stepper.begin(setup.circles, setup.boxes, setup.area, setup.parameters);
    for (std::size_t block = 0; block < block_count(setup.circles.size()); ++block) {
        stepper.accelerate(setup.circles, block, {none.data(), none.data()});
    }
    before_collisions();
    stepper.collide(setup.circles, setup.boxes, executor);
    after_collisions();
    for (std::size_t block = 0; block < block_count(setup.circles.size()); ++block) {
        stepper.move(setup.circles, block);
    }
    stepper.finish(setup.boxes);
}

TEST(ACrowd, ChangesMomentumOnlyByWallsAndDamping) {
    // Without obstacles, which take up momentum as walls do. A float has 24 bits: rounding changes a velocity by a
    // share of 6e-8.
    TestBodies setup = crowd(0.5, 21);
    Boxes crates;
    for (std::size_t i = 0; i < setup.boxes.size(); ++i) {
        if (setup.boxes.inverse_mass[i] > 0) {
            crates.add(setup.boxes.x[i], setup.boxes.y[i], setup.boxes.half_width[i], setup.boxes.half_height[i],
                       0.25f);
        }
    }
    setup.boxes = crates;
    base::InlineExecutor executor;
    const auto kept = static_cast<double>(setup.parameters.integration.velocity_kept);
    std::uint64_t touched_walls = 0;
    for (int tick = 0; tick < 300; ++tick) {
        const Motion before = motion_of(setup);
        Motion walls = impulse_of_walls(setup, false);
        walls.x *= kept;
        walls.y *= kept;
        // Velocities → positions is the last step: its bounces depend on where all bodies would be without walls.
        TestBodies unbounded = setup;
        unbounded.stepper = {};
        Motion late_walls;
        Motion after_contacts;
        step_in_parts(
            setup, executor, [] {},
            [&] {
                after_contacts = motion_of(setup);
                unbounded.circles = setup.circles;
                unbounded.boxes = setup.boxes;
                const float tick_s = setup.parameters.integration.tick_s;
                const auto move = [&](Bodies& bodies) {
                    for (std::size_t i = 0; i < bodies.x.size(); ++i) {
                        if (bodies.inverse_mass[i] > 0) {
                            bodies.x[i] += to_units(bodies.velocity_x[i] * tick_s);
                            bodies.y[i] += to_units(bodies.velocity_y[i] * tick_s);
                        }
                    }
                };
                move(unbounded.circles);
                move(unbounded.boxes);
                late_walls = impulse_of_walls(unbounded, true);
            });
        const Motion after = motion_of(setup);
        ASSERT_NEAR(after_contacts.x, before.x * kept + walls.x, before.size * 2e-6) << "tick " << tick;
        ASSERT_NEAR(after_contacts.y, before.y * kept + walls.y, before.size * 2e-6) << "tick " << tick;
        ASSERT_NEAR(after.x, after_contacts.x + late_walls.x, before.size * 2e-6) << "tick " << tick;
        ASSERT_NEAR(after.y, after_contacts.y + late_walls.y, before.size * 2e-6) << "tick " << tick;
        touched_walls += walls.x != 0 || late_walls.x != 0;
    }
    EXPECT_GT(touched_walls, 100u);
}

TEST(ACrowd, NeverGainsKineticEnergyThroughContacts) {
    TestBodies setup = crowd(0.5, 22);
    base::InlineExecutor executor;
    double before = 0;
    for (int tick = 0; tick < 300; ++tick) {
        step_in_parts(
            setup, executor, [&] { before = motion_of(setup).energy; },
            [&] { ASSERT_LE(motion_of(setup).energy, before * (1 + 1e-6)) << "tick " << tick; });
    }
}

TEST(ACrowd, OverlapsLessThanHalfARadiusAndStaysInsideTheWalls) {
    TestBodies setup = crowd(0.5, 23);
    base::InlineExecutor executor;
    base::RandomStream random = test_stream(24);
    for (int tick = 0; tick < 600; ++tick) {
        // Like organisms: up to 250 gene units of force in any direction.
        for (std::size_t i = 0; i < setup.circles.size(); ++i) {
            const float x = uniform_float(random, -250, 250);
            setup.push(i, x, uniform_float(random, -250, 250));
        }
        setup.step(executor);
        for (std::size_t i = 0; i < setup.circles.size(); ++i) {
            const Coordinate radius = to_units(setup.circles.radius[i]);
            ASSERT_GE(setup.circles.x[i], radius) << "tick " << tick;
            ASSERT_LE(setup.circles.x[i], setup.area.width - radius) << "tick " << tick;
            ASSERT_GE(setup.circles.y[i], radius) << "tick " << tick;
            ASSERT_LE(setup.circles.y[i], setup.area.height - radius) << "tick " << tick;
        }
        // At the random start circles overlap completely; they take a second to separate.
        if (tick > 120 && tick % 20 == 0) {
            ASSERT_LT(deepest_overlap(setup), 0.5) << "tick " << tick;
        }
    }
}

TEST(ACrowd, MovesAlikeOnAnyThreadCountAndWithNewPairLists) {
    TestBodies one = crowd(0.5, 25), many = one, fresh = one;
    base::InlineExecutor executor;
    jobs::ThreadPool threads{3};
    for (int tick = 0; tick < 150; ++tick) {
        one.step(executor);
        many.step(threads);
        fresh.stepper.near().invalidate();
        fresh.step(executor);
        ASSERT_EQ(many.circles.x, one.circles.x) << "tick " << tick;
        ASSERT_EQ(many.circles.velocity_y, one.circles.velocity_y) << "tick " << tick;
        ASSERT_EQ(many.boxes.velocity_x, one.boxes.velocity_x) << "tick " << tick;
        ASSERT_EQ(fresh.circles.x, one.circles.x) << "tick " << tick;
        ASSERT_EQ(fresh.circles.velocity_y, one.circles.velocity_y) << "tick " << tick;
        ASSERT_EQ(fresh.boxes.velocity_x, one.boxes.velocity_x) << "tick " << tick;
    }
}

TEST(ACrowd, ResolvesContactsAsIfOneByOneInOrderOfIds) {
    // Circles only, stored in another order than by id.
    TestBodies setup;
    setup.area = {to_units(side), to_units(side)};
    base::RandomStream random = test_stream(26);
    std::vector<std::uint32_t> ids(2500);
    for (std::uint32_t i = 0; i < ids.size(); ++i) {
        ids[i] = i;
    }
    random.shuffle(std::span{ids});
    for (const std::uint32_t id : ids) {
        const Coordinate x = to_units(random.uniform(10, side - 10)), y = to_units(random.uniform(10, side - 10));
        setup.circles.add({.id = id, .x = x, .y = y, .radius = 10, .mass = 1});
        setup.circles.velocity_x[setup.circles.size() - 1] = uniform_float(random, -100, 100);
    }
    Circles expected = setup.circles;
    std::vector<std::size_t> by_id(ids.size());
    for (std::size_t i = 0; i < ids.size(); ++i) {
        by_id[ids[i]] = i;
    }
    struct Touching {
        std::size_t a, b;
    };
    std::vector<Touching> touching;
    const auto overlap_of = [&](std::size_t a, std::size_t b) {
        return circle_circle(distance_px(expected.x[a], expected.x[b]), distance_px(expected.y[a], expected.y[b]), 10,
                             10);
    };
    for (const std::size_t a : by_id) {
        for (std::uint32_t id = expected.id[a] + 1; id < ids.size(); ++id) {
            if (overlap_of(a, by_id[id]).touching) {
                touching.push_back({a, by_id[id]});
            }
        }
    }
    for (const auto& [a, b] : touching) {
        const Overlap overlap = overlap_of(a, b);
        if (!overlap.touching) {
            continue;
        }
        const float nx = overlap.normal_x, ny = overlap.normal_y;
        expected.x[a] -= to_units(nx * overlap.depth * 0.5f);
        expected.y[a] -= to_units(ny * overlap.depth * 0.5f);
        expected.x[b] += to_units(nx * overlap.depth * 0.5f);
        expected.y[b] += to_units(ny * overlap.depth * 0.5f);
        const float approach = (expected.velocity_x[b] - expected.velocity_x[a]) * nx +
                               (expected.velocity_y[b] - expected.velocity_y[a]) * ny;
        if (approach >= 0) {
            continue;
        }
        const float impulse = -(1 + 0.8f) * approach / 2;
        expected.velocity_x[a] -= impulse * nx;
        expected.velocity_y[a] -= impulse * ny;
        expected.velocity_x[b] += impulse * nx;
        expected.velocity_y[b] += impulse * ny;
    }
    ASSERT_GT(touching.size(), 1500u);
    Contacts contacts;
    jobs::ThreadPool threads{3};
    contacts.find(setup.circles, setup.boxes, setup.area, threads);
    EXPECT_EQ(contacts.size(), touching.size());
    contacts.resolve(setup.circles, setup.boxes, 0.8f, threads);
    EXPECT_EQ(setup.circles.x, expected.x);
    EXPECT_EQ(setup.circles.y, expected.y);
    EXPECT_EQ(setup.circles.velocity_x, expected.velocity_x);
    EXPECT_EQ(setup.circles.velocity_y, expected.velocity_y);
}

TEST(ACrowd, OnOneCrateIsResolvedAlikeOnAnyThreadCount) {
    // A body with thousands of contacts resolves one per round, so most are resolved in order at the end.
    TestBodies one;
    base::RandomStream random = test_stream(27);
    for (int i = 0; i < 4000; ++i) {
        const double x = random.uniform(1000, 3000);
        one.add_circle(x, random.uniform(1000, 3000), uniform_float(random, 1, 3), 1, uniform_float(random, -50, 50));
    }
    one.add_box(2000, 2000, 900, 900, 0.001f);
    TestBodies many = one;
    base::InlineExecutor executor;
    jobs::ThreadPool threads{3};
    for (int tick = 0; tick < 20; ++tick) {
        one.step(executor);
        many.step(threads);
        ASSERT_EQ(many.circles.x, one.circles.x) << "tick " << tick;
        ASSERT_EQ(many.circles.velocity_x, one.circles.velocity_x) << "tick " << tick;
        ASSERT_EQ(many.boxes.velocity_x, one.boxes.velocity_x) << "tick " << tick;
    }
}

} // namespace
} // namespace evod::physics
