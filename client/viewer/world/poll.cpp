#include "client/viewer/world/poll.h"

#include <utility>

namespace evod::viewer {

bool Poll::due(const ViewedWorld& world, Clock::time_point now) {
    if (state_->place != world.feed.place_number()) {
        reset();
        state_->place = world.feed.place_number();
    }
    if (state_->sent) {
        return now - *state_->sent > answer_timeout;
    }
    return state_->due_now || now >= state_->next;
}

void Poll::send(ViewedWorld& world, evod::v1::Request request, Clock::time_point now, Handler handler) {
    const std::uint64_t number = ++state_->number, place = state_->place = world.feed.place_number();
    state_->sent = now;
    state_->due_now = false;
    world.server.send(
        std::move(request), [weak = std::weak_ptr{state_}, number, place, interval = interval_, &world,
                             handler = std::move(handler)](const core::Result<evod::v1::Response>& response) {
            const auto state = weak.lock();
            if (!state || state->number != number || world.feed.place_number() != place) {
                return;
            }
            const bool accepted = response && core::accepted(*response);
            state->sent.reset();
            state->next = Clock::now() + (accepted ? interval : Clock::duration{after_refusal});
            state->problem = refusal_of(response);
            state->unsupported = response && (response->status().code() == evod::v1::CODE_UNIMPLEMENTED ||
                                              response->status().reason() == evod::v1::REASON_RUNS_NOT_KEPT);
            handler(accepted ? &*response : nullptr);
        });
}

void Poll::wait(Clock::duration delay) {
    state_->next = Clock::now() + delay;
}

void Poll::reset() {
    const std::uint64_t number = state_->number;
    *state_ = State{.number = number + 1, .place = state_->place};
}

} // namespace evod::viewer
