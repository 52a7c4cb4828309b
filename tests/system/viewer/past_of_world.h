// PastOfWorld: what the server says a world looked like, asked for over a connection of the test's own.
#pragma once

#include "tests/system/viewer/person.h"
#include "tests/system/viewer/processes.h"

namespace evod::viewer {

/// A world of short generations, 120 ticks each, that has come to `tick` and is paused there.
inline void make_world(RealServer& server, const std::string& name, std::uint64_t tick, std::uint64_t seed = 3,
                       std::uint32_t island_count = 1) {
    evod::v1::Request create, speed, run, look;
    auto& wanted = *create.mutable_create_world();
    wanted.set_name(name);
    wanted.set_seed(seed);
    const auto add = [&](const char* parameter) {
        auto& added = *wanted.add_parameters();
        added.set_name(parameter);
        return added.mutable_value();
    };
    add("generation_s")->set_real(2);
    add("population_size")->set_count(20);
    add("island_count")->set_count(island_count);
    server.ask(create);
    speed.mutable_set_speed()->set_world(name);
    speed.mutable_set_speed()->mutable_speed()->set_max(true);
    server.ask(speed);
    run.mutable_run_until_tick()->set_world(name);
    run.mutable_run_until_tick()->set_tick(tick);
    server.ask(run);
    look.mutable_get_statistics()->set_world(name);
    EXPECT_TRUE(comes_true([&] {
        const auto world = server.ask(look);
        return world.tick() == tick && world.state() == evod::v1::RUN_STATE_PAUSED;
    }));
}

/// A picture of a world as it stands.
inline std::shared_ptr<const wire::Picture> picture_of(RealServer& server, const std::string& world,
                                                       std::uint32_t island = 0) {
    evod::v1::SubscribeSnapshots subscription;
    subscription.set_world(world);
    subscription.set_island(island);
    subscription.set_rate_hz(60);
    const auto pictures = server.connection->subscribe(subscription);
    std::shared_ptr<const wire::Picture> picture;
    EXPECT_TRUE(comes_true([&] {
        picture = server.connection->take_picture(pictures, island);
        return picture != nullptr;
    }));
    server.connection->unsubscribe(pictures);
    return picture;
}

/// A picture of what a world was at a moment.
inline std::shared_ptr<const wire::Picture> past_picture_of(RealServer& server, const std::string& world,
                                                            const evod::v1::RunMoment& moment) {
    evod::v1::Request open, close;
    open.mutable_open_past()->set_world(world);
    *open.mutable_open_past()->mutable_at() = moment;
    const std::string name = server.ask(open).name();
    auto picture = picture_of(server, name);
    close.mutable_close_past()->set_world(name);
    server.ask(close);
    return picture;
}

inline evod::v1::RunMoment at_tick(std::uint64_t tick) {
    evod::v1::RunMoment moment;
    moment.set_tick(tick);
    return moment;
}

inline evod::v1::RunMoment at_generation(std::uint64_t generation) {
    evod::v1::RunMoment moment;
    moment.set_generation(generation);
    return moment;
}

} // namespace evod::viewer
