// PastOfWorld: what the server says a world looked like, asked for over a connection of the test's own.
#pragma once

#include "tests/system/viewer/support/processes.h"

namespace evod::viewer {

/// A world of short generations, 120 ticks each, that has come to `tick` and is paused there.
inline void make_world(RealServer& server, const std::string& name, std::uint64_t tick, std::uint64_t seed = 3,
                       std::uint32_t island_count = 1) {
    server.make_world({.name = name,
                       .seed = seed,
                       .parameters = {{"generation_s", real(2)},
                                      {"population_size", count(20)},
                                      {"island_count", count(island_count)}}});
    server.run_to(name, tick);
}

/// A picture of a world as it stands.
inline std::shared_ptr<const codec::DecodedSnapshot> picture_of(RealServer& server, const std::string& world,
                                                                std::uint32_t island = 0) {
    evod::v1::SubscribeSnapshots subscription;
    subscription.set_world(world);
    subscription.set_island(island);
    subscription.set_rate_hz(60);
    const auto pictures = server.connection->subscribe(subscription);
    std::shared_ptr<const codec::DecodedSnapshot> picture;
    EXPECT_TRUE(wait_until([&] {
        picture = server.connection->take_snapshot(pictures, island);
        return picture != nullptr;
    }));
    server.connection->unsubscribe(pictures);
    return picture;
}

/// A picture of what a world was at a moment.
inline std::shared_ptr<const codec::DecodedSnapshot> past_picture_of(RealServer& server, const std::string& world,
                                                                     const evod::v1::RunMoment& moment) {
    evod::v1::Request open, close;
    open.mutable_open_replay()->set_world(world);
    *open.mutable_open_replay()->mutable_at() = moment;
    const std::string name = server.ask(open).name();
    auto picture = picture_of(server, name);
    close.mutable_close_replay()->set_world(name);
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
