// Loop outputs: where the results of a simulation loop go.
#pragma once

#include "server/metrics/worlds.h"
#include "server/runtime/replies.h"
#include "server/runtime/snapshot.h"
#include "server/simulation/laboratory.h"

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace evod::runtime {

/// The functions run on the simulation thread, unless stated otherwise.
struct LoopOutputs {
    /// Returns whose replay a world is; empty: it is a live world.
    using UserOf = std::function<std::string(const std::string& world)>;
    std::function<void(const simulation::Laboratory&, std::vector<simulation::Event>, const UserOf&)> events;
    UserOf user_of = [](const std::string&) { return std::string{}; }; // set by the loop
    std::function<void(SnapshotPtr)> snapshot;
    /// Receives the replies. If runs are stored, also receives the receipts, on the storage thread.
    std::function<void(Reply)> reply = [](Reply) {};
    /// Receives a new state of the disk.
    std::function<void(const simulation::Storage&)> storage = [](const simulation::Storage&) {};
    /// Receives a new state of the disk for one world, whose run file was moved or deleted, or is back.
    std::function<void(const std::string& world, const simulation::Storage&)> storage_of_world = [](auto&&...) {};
    /// Receives a world that has stopped, because its run file is damaged.
    std::function<void(const simulation::DamagedWorld&)> damaged = [](const simulation::DamagedWorld&) {};
    /// The metrics of each live world. Must outlive the loop; nullptr: no metrics.
    metrics::Worlds* counted = nullptr;

    void publish_events(simulation::Laboratory& laboratory) const {
        auto new_events = laboratory.take_events();
        if (!new_events.empty()) {
            events(laboratory, std::move(new_events), user_of);
        }
    }
};

} // namespace evod::runtime
