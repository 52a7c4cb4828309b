// Snapshots of a world and of its replays, requested from the server over the test's connection.
#pragma once

#include "tests/system/viewer/support/processes.h"

namespace evod::viewer {

/// Makes a world with short generations of 120 ticks, and runs it to `tick`, where it is paused.
inline void make_world(RealServer& server, const std::string& name, std::uint64_t tick, std::uint64_t seed = 3,
                       std::uint32_t island_count = 1) {
    server.make_world({.name = name,
                       .seed = seed,
                       .parameters = {{"generation_s", real(2)},
                                      {"population_size", count(20)},
                                      {"island_count", count(island_count)}}});
    server.run_to(name, tick);
}

/// The current snapshot of a world.
inline std::shared_ptr<const codec::ReceivedSnapshot> snapshot_of(RealServer& server, const std::string& world,
                                                                  std::uint32_t island = 0) {
    evod::v1::SubscribeSnapshots subscription;
    subscription.set_world(world);
    subscription.set_island(island);
    subscription.set_rate_hz(60);
    const auto subscription_handle = server.connection->subscribe(subscription);
    std::shared_ptr<const codec::ReceivedSnapshot> snapshot;
    EXPECT_TRUE(wait_until([&] {
        snapshot = server.connection->take_snapshot(subscription_handle, island);
        return snapshot != nullptr;
    }));
    server.connection->unsubscribe(subscription_handle);
    return snapshot;
}

/// The snapshot of a world at an earlier moment.
inline std::shared_ptr<const codec::ReceivedSnapshot> replay_snapshot_of(RealServer& server, const std::string& world,
                                                                         const evod::v1::RunMoment& moment) {
    evod::v1::Request open, close;
    open.mutable_open_replay()->set_world(world);
    *open.mutable_open_replay()->mutable_at() = moment;
    const std::string name = server.ask(open).name();
    auto snapshot = snapshot_of(server, name);
    close.mutable_close_replay()->set_world(name);
    server.ask(close);
    return snapshot;
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
