#include "client/viewer/watch/inquiry.h"

#include "client/viewer/watch/readout.h"

#include <utility>

namespace evod::viewer {

bool Inquiry::due(const Watch& watch, Clock::time_point now) {
    if (state_->place != watch.place_number()) {
        forget();
        state_->place = watch.place_number();
    }
    if (state_->asked) {
        return now - *state_->asked > patience;
    }
    return state_->hurried || now >= state_->next;
}

void Inquiry::ask(Watch& watch, evod::v1::Request request, Clock::time_point now, Handler handler) {
    const std::uint64_t number = ++state_->number, place = state_->place = watch.place_number();
    state_->asked = now;
    state_->hurried = false;
    watch.ask(std::move(request), [weak = std::weak_ptr{state_}, number, place, pause = pause_, &watch,
                                   handler = std::move(handler)](const core::Result<evod::v1::Response>& response) {
        const auto state = weak.lock();
        if (!state || state->number != number || watch.place_number() != place) {
            return;
        }
        const bool good = response && core::accepted(*response);
        state->asked.reset();
        state->next = Clock::now() + (good ? pause : Clock::duration{after_refusal});
        state->trouble = good ? "" : response ? shown_refusal(response->status()) : response.error().what;
        state->unknown = response && response->status().code() == evod::v1::CODE_UNIMPLEMENTED;
        handler(good ? &*response : nullptr);
    });
}

void Inquiry::wait(Clock::duration pause) {
    state_->next = Clock::now() + pause;
}

void Inquiry::forget() {
    const std::uint64_t number = state_->number;
    *state_ = State{.number = number + 1, .place = state_->place};
}

} // namespace evod::viewer
