#include "server/network/requests_in_flight.h"

#include "server/network/limits.h"

#include <utility>

namespace evod::network {

bool RequestsInFlight::admit() {
    if (unanswered_ >= requests_in_flight_max) {
        return false;
    }
    ++unanswered_;
    return true;
}

void RequestsInFlight::expect(std::ptrdiff_t bytes) {
    if (!closed_) {
        expected_bytes_.set(expected_bytes_.bytes() + static_cast<std::size_t>(bytes));
    }
}

void RequestsInFlight::begin_command(std::size_t bytes) {
    ++commands_under_way;
    expect(static_cast<std::ptrdiff_t>(bytes));
}

void RequestsInFlight::end_command(std::size_t bytes) {
    --commands_under_way;
    expect(-static_cast<std::ptrdiff_t>(bytes));
}

void RequestsInFlight::hold_back(v1::Request request) {
    constexpr std::size_t of_allocations = 64;
    const std::size_t bytes = request.SpaceUsedLong() + of_allocations;
    held_back_bytes_.set(held_back_bytes_.bytes() + bytes);
    held_back_.push_back({std::move(request), bytes});
}

std::optional<v1::Request> RequestsInFlight::take_held_back() {
    if (held_back_.empty()) {
        return std::nullopt;
    }
    HeldBack next = std::move(held_back_.front());
    held_back_.pop_front();
    held_back_bytes_.set(held_back_bytes_.bytes() - next.bytes);
    return std::move(next.request);
}

void RequestsInFlight::close() {
    closed_ = true;
    expected_bytes_.set(0);
    held_back_.clear();
    held_back_bytes_.set(0);
}

} // namespace evod::network
