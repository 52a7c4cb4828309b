#include "client/viewer/panels/plots/run_history.h"

#include <imgui.h>

#include <utility>

namespace evod::viewer {

void RunHistory::update(ViewedWorld& world, Poll::Clock::time_point now) {
    const RunControl& control = world.feed.control();
    if (control.known()) {
        history_.set_run(control.world(), control.run_id());
    }
    const codec::ReceivedSnapshot* snapshot = world.feed.snapshot();
    if (snapshot != nullptr && snapshot->about.run_id() == history_.run_id() && snapshot->about.generation() > 0) {
        history_.set_ended(snapshot->about.generation() - 1);
    }
    history_.set_gene_names(world.feed.gene_names());
    update_other(world, now);
}

void RunHistory::update_other(ViewedWorld& world, Poll::Clock::time_point now) {
    const int frame = ImGui::GetFrameCount();
    const std::uint64_t place = world.feed.place_number(), connected_count = world.server.status().connected_count;
    if (place != place_ || connected_count != connected_count_ || frame > frame_ + 1) {
        history_.refresh(); // events may have been missed
    }
    place_ = place;
    connected_count_ = connected_count;
    frame_ = frame;
    for (const evod::v1::Event& event : world.feed.events()) {
        history_.apply_event(event);
        if (event.has_generation_finished() && world.replay.info() != nullptr) {
            history_.refresh(); // a replay reports no changes of parameters by events
        }
    }
    send_query(world, now);
}

void RunHistory::send_query(ViewedWorld& world, Poll::Clock::time_point now) {
    if (!poll_.due(world, now)) {
        return;
    }
    if (history_.pending()) { // the answer has timed out
        history_.cancel();
    }
    if (auto query = history_.next_query()) {
        poll_.send(world, std::move(query->request), now,
                   [this, number = query->number](const evod::v1::Response* response) {
                       history_.receive(number, response != nullptr ? &response->history() : nullptr);
                   });
    }
}

} // namespace evod::viewer
