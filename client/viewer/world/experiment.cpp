#include "client/viewer/world/experiment.h"

#include <utility>

namespace evod::viewer {
namespace {

bool has_bodies(const evod::v1::ParameterSet& set) {
    std::string fitness;
    bool external_bodies = true;
    for (const evod::v1::ParameterState& parameter : set.parameters()) {
        if (parameter.name() == "fitness") {
            fitness = parameter.value().choice();
        } else if (parameter.name() == "external_bodies") {
            external_bodies = parameter.value().flag();
        }
    }
    return fitness == "life" || (fitness == "external" && external_bodies);
}

} // namespace

void Experiment::update(ViewedWorld& world, Poll::Clock::time_point now) {
    const RunControl& control = world.feed.control();
    if (!control.known()) {
        return;
    }
    if (control.world() != world_ || control.run_id() != run_id_) {
        world_ = control.world();
        run_id_ = control.run_id();
        text_.clear();
        stale_ = true;
    }
    stale_ = stale_ || connected_count_ != world.server.status().connected_count;
    connected_count_ = world.server.status().connected_count;
    for (const evod::v1::Event& event : world.feed.events()) {
        stale_ =
            stale_ || event.has_parameters_changed() || event.has_generation_finished() || event.has_events_dropped();
    }
    if (!stale_ || !poll_.due(world, now)) {
        return;
    }
    stale_ = false;
    evod::v1::Request request;
    request.mutable_get_parameters()->set_world(world_);
    poll_.send(world, std::move(request), now, [this](const evod::v1::Response* response) {
        if (response != nullptr) {
            text_ = response->parameters().summary();
            has_bodies_ = viewer::has_bodies(response->parameters());
        } else {
            stale_ = true;
        }
    });
}

} // namespace evod::viewer
