#include "client/viewer/world/server_connection.h"

#include "client/viewer/world/status_text.h"

#include <algorithm>
#include <cstddef>

namespace evod::viewer {

namespace {

core::Options with_client_name(core::Options options) {
    options.client_name = "evoview";
    options.client_version = EVOD_VERSION;
    return options;
}

} // namespace

ServerConnection::ServerConnection(core::Options options)
    : options_{with_client_name(std::move(options))}, connection_{options_} {}

void ServerConnection::send(evod::v1::Request request, AnswerHandler handler, std::chrono::milliseconds timeout) {
    unanswered_.push_back({std::move(handler), connection_.send(std::move(request), timeout)});
}

void ServerConnection::take_answers() {
    for (std::size_t i = 0; i < unanswered_.size();) {
        if (unanswered_[i].response.wait_for(std::chrono::seconds{0}) != std::future_status::ready) {
            ++i;
            continue;
        }
        Unanswered answered = std::move(unanswered_[i]); // moved out, because the handler may change unanswered_
        unanswered_.erase(unanswered_.begin() + static_cast<std::ptrdiff_t>(i));
        answered.handler(answered.response.get());
    }
}

std::optional<evod::v1::Welcome> ServerConnection::take_welcome() {
    const core::ConnectionStatus now = status();
    if (now.connected_count == connected_count_) {
        return std::nullopt;
    }
    connected_count_ = now.connected_count;
    const evod::v1::Welcome welcome = now.welcome.value_or(evod::v1::Welcome{});
    role_ = welcome.role();
    return welcome;
}

std::string ServerConnection::problem() const {
    return connection_loss_text(status(), !options_.token.empty());
}

bool ServerConnection::report_if_refused(const core::Result<evod::v1::Response>& response) {
    std::string refusal = refusal_of(response);
    const bool accepted = refusal.empty();
    if (!accepted) {
        notice(std::move(refusal));
    }
    return accepted;
}

std::string refusal_of(const core::Result<evod::v1::Response>& response) {
    return !response ? response.error().what : core::accepted(*response) ? "" : refusal_text(response->status());
}

} // namespace evod::viewer
