#include "client/core/protocol_state.h"

#include "client/core/number_check.h"

#include <algorithm>
#include <utility>

namespace evod::core {

namespace {

/// Returns `now` + `wait`. Returns TimePoint::max() for waits of more than 100 years, because the sum could overflow.
TimePoint after(TimePoint now, std::chrono::milliseconds wait) {
    return wait > std::chrono::years{100} ? TimePoint::max() : now + wait;
}

Ending refused(const Endpoint& server, const evod::v1::Status& status, const char* did, bool final) {
    return {.reason = "the server at " + to_text(server) + " " + did + ": " + to_text(status),
            .final = final,
            .late = status.code() == evod::v1::CODE_RESOURCE_EXHAUSTED,
            .token_needed = status.code() == evod::v1::CODE_UNAUTHENTICATED,
            .refusal = status};
}

} // namespace

void EventQueue::push(evod::v1::Event event) {
    events_.push_back(std::move(event));
    if (events_.size() > kept_) {
        events_.pop_front();
        ++dropped_count_;
    }
}

std::optional<evod::v1::Event> EventQueue::pop() {
    evod::v1::Event event;
    if (dropped_count_ > 0) {
        event.mutable_events_dropped()->set_dropped_count(std::exchange(dropped_count_, 0));
    } else if (!events_.empty()) {
        event = std::move(events_.front());
        events_.pop_front();
    } else {
        return std::nullopt;
    }
    return event;
}

ProtocolState::ProtocolState(Options options, std::string client_key, std::uint32_t jitter, TimePoint now)
    : options_{std::move(options)}
    , token_{options_.token}
    , requests_{std::move(client_key)}
    , backoff_{options_.backoff_min}
    , jitter_{jitter} {
    begin_session(now);
}

void ProtocolState::opened(TimePoint now) {
    evod::v1::ClientMessage message;
    auto& hello = *message.mutable_hello();
    hello.set_protocol_version(codec::protocol_version);
    hello.set_client_name(options_.client_name);
    hello.set_client_version(options_.client_version);
    if (token_.empty() && options_.join) {
        hello.mutable_join()->set_code(options_.join->code);
        hello.mutable_join()->set_name(options_.join->name);
    } else {
        hello.set_token(token_);
    }
    hello.set_frame_bytes_max(*codec::client_limits.control_bytes_max);
    output_.bytes = codec::encode_frame(codec::Channel::Control, message);
    session_.opened = true;
    deadline_ = after(now, options_.connect_timeout);
}

void ProtocolState::received(std::span<const std::byte> bytes, TimePoint now) {
    session_.reader.feed(bytes);
    while (connection_wanted()) {
        const auto frame = session_.reader.next();
        if (!frame) {
            // A peer that never sent a valid message is not an evod server: reconnecting would not help. After a
            // Welcome the damage may be temporary.
            const bool welcomed = status_.state == State::Connected;
            const char* const what = welcomed ? " sent damaged data: " : " is not an evod server: ";
            end_session({.reason = to_text(options_.server) + what + frame.error().what, .final = !welcomed}, now);
        } else if (*frame) {
            take_frame(**frame, now);
        } else {
            return;
        }
    }
}

void ProtocolState::lost(Ending ending, TimePoint now) {
    if (session_.going_away) {
        ending = {.reason = "the server at " + to_text(options_.server) + " was shut down"};
    }
    end_session(std::move(ending), now);
}

void ProtocolState::advance(TimePoint now) {
    if (now >= deadline_ && status_.state == State::Lost) {
        begin_session(now);
    } else if (now >= deadline_) {
        end_session({.reason = (session_.opened ? "no Welcome from " : "no connection with ") +
                               to_text(options_.server) + " within " +
                               std::to_string(options_.connect_timeout.count()) +
                               " ms: check the address and the network"},
                    now);
    }
    const bool explained = status_.state != State::Connected && !status_.reason.empty();
    requests_.expire(now, explained ? ": " + status_.reason : "");
    if (now >= give_up_at()) {
        requests_.give_up({.kind = Error::Kind::NoConnection, .what = status_.reason});
    }
}

ProtocolState::Output ProtocolState::take_output() {
    if (status_.state == State::Connected) {
        output_.bytes += requests_.take_frames();
    }
    output_.connection_wanted = connection_wanted();
    output_.wake_at = std::min(deadline_, requests_.next_deadline());
    if (requests_.has_request_of_program()) {
        output_.wake_at = std::min(output_.wake_at, give_up_at());
    }
    output_.outcomes = requests_.take_outcomes();
    output_.snapshots = subscriptions_.take_snapshots();
    output_.answers = subscriptions_.answers();
    output_.status = status_;
    return std::exchange(output_, {});
}

void ProtocolState::request(evod::v1::Request request, Handler handler, std::chrono::milliseconds timeout,
                            TimePoint now) {
    requests_.add(std::move(request),
                  {.handler = std::move(handler), .timeout = timeout, .deadline = after(now, timeout)});
}

TimePoint ProtocolState::give_up_at() const {
    return lost_since_ && options_.unreachable_max ? after(*lost_since_, *options_.unreachable_max) : TimePoint::max();
}

void ProtocolState::close() {
    status_.state = State::Failed;
    status_.reason = "the connection was closed by this program";
    deadline_ = TimePoint::max();
    output_.bytes.clear();
    requests_.end_session({.kind = Error::Kind::Closed, .what = status_.reason}, false);
}

void ProtocolState::begin_session(TimePoint now) {
    session_ = {};
    status_.state = State::Connecting;
    deadline_ = after(now, options_.connect_timeout);
}

void ProtocolState::end_session(Ending ending, TimePoint now) {
    const bool another = options_.reconnect && !ending.final;
    status_.state = another ? State::Lost : State::Failed;
    status_.reason = std::move(ending.reason);
    status_.token_needed = ending.token_needed;
    status_.refusal = std::move(ending.refusal);
    output_.bytes.clear();
    subscriptions_.end_session();
    requests_.end_session({.kind = Error::Kind::NoConnection, .what = status_.reason}, another);
    deadline_ = TimePoint::max();
    if (another) {
        if (status_.connected_count > 0 && !lost_since_) {
            lost_since_ = now;
        }
        // The server ended the session because it is full: another attempt soon would take the place of another client,
        // or of another session of the same user.
        backoff_ = ending.late ? options_.backoff_max : backoff_;
        // Waits are random, so that the clients of a server do not all reconnect at the same moment.
        const auto spread = std::uniform_real_distribution{0.5, 1.0}(jitter_);
        deadline_ = now + std::chrono::duration_cast<std::chrono::milliseconds>(backoff_ * spread);
        backoff_ = std::min(2 * backoff_, options_.backoff_max);
    }
}

void ProtocolState::take_frame(const codec::Frame& frame, TimePoint now) {
    const std::string server = to_text(options_.server);
    if (frame.channel == codec::Channel::Control) {
        if (auto message = codec::parse_body<evod::v1::ServerMessage>(frame.body); !message) {
            end_session({.reason = server + " sent damaged data: " + message.error().what}, now);
        } else if (const std::string field = field_without_number(*message); !field.empty()) {
            end_session({.reason = server + " sent damaged data: " + field + " is not a number that is allowed"}, now);
        } else if (status_.state != State::Connected) {
            take_first_message(*message, now);
        } else {
            take_message(*std::move(message), now);
        }
    } else if (status_.state != State::Connected) {
        end_session({.reason = server + " is not an evod server: its first message is a snapshot", .final = true}, now);
    } else if (auto snapshot = codec::parse_body<evod::v1::SnapshotFrame>(frame.body)) {
        output_.bytes += subscriptions_.take_snapshot(*std::move(snapshot), status_);
    } else {
        end_session({.reason = server + " sent damaged data: " + snapshot.error().what}, now);
    }
}

void ProtocolState::take_first_message(const evod::v1::ServerMessage& message, TimePoint now) {
    const std::string server = to_text(options_.server);
    if (message.has_goodbye()) {
        const auto code = message.goodbye().status().code();
        const bool later = code == evod::v1::CODE_RESOURCE_EXHAUSTED || code == evod::v1::CODE_UNAVAILABLE;
        end_session(refused(options_.server, message.goodbye().status(), "refused us", !later), now);
    } else if (!message.has_welcome()) {
        end_session({.reason = server + " is not an evod server: its first message is not a Welcome", .final = true},
                    now);
    } else if (message.welcome().protocol_version() != codec::protocol_version) {
        end_session({.reason = "the server at " + server + " uses protocol version " +
                               std::to_string(message.welcome().protocol_version()) + ", this program version " +
                               std::to_string(codec::protocol_version) + ": use a program of the server's version",
                     .final = true},
                    now);
    } else {
        status_.state = State::Connected;
        status_.reason.clear();
        status_.refusal.reset();
        status_.welcome = message.welcome();
        if (const std::string& token = message.welcome().membership().token(); !token.empty()) {
            token_ = token;
        }
        ++status_.connected_count;
        deadline_ = TimePoint::max();
        lost_since_.reset();
        backoff_ = options_.backoff_min;
        requests_.begin_session(message.welcome().limits());
        // Subscriptions are sent first, so that the program receives the events that its requests cause.
        subscriptions_.begin_session();
    }
}

void ProtocolState::take_message(evod::v1::ServerMessage message, TimePoint now) {
    if (message.has_response()) {
        const auto answered = requests_.answer(message.response());
        if (answered && answered->sets_view) {
            subscriptions_.take_view_answer(answered->handle, message.response());
        } else if (answered) {
            subscriptions_.take_answer(answered->handle, std::move(*message.mutable_response()));
        }
    } else if (message.has_event()) {
        session_.going_away = session_.going_away || message.event().has_server_going_away();
        output_.events.push_back(std::move(*message.mutable_event()));
    } else if (message.has_goodbye()) {
        // Another session would end for the same reason.
        const auto code = message.goodbye().status().code();
        const bool final = code == evod::v1::CODE_UNAUTHENTICATED || code == evod::v1::CODE_PERMISSION_DENIED ||
                           code == evod::v1::CODE_INVALID_ARGUMENT;
        end_session(refused(options_.server, message.goodbye().status(), "ended the session", final), now);
    }
}

} // namespace evod::core
