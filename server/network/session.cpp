#include "server/network/session.h"

#include "server/log/log.h"
#include "server/network/detached.h"
#include "server/network/no_throw.h"
#include "server/protocol/hello.h"
#include "server/protocol/refusals.h"

#include <boost/asio/buffer.hpp>
#include <boost/asio/co_spawn.hpp>

#include <netinet/tcp.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <tuple>
#include <utility>
#include <vector>

namespace evod::network {

SessionPtr find_session(const Sessions& sessions, std::uint64_t number) {
    const auto found = sessions.find(number);
    return found == sessions.end() ? nullptr : found->second;
}

Session::Session(tcp::socket socket, SessionHost& host, std::uint64_t number)
    : Session{std::make_unique<Transport>(std::move(socket), host.tls), host, number} {}

Session::Session(std::unique_ptr<Transport> transport, SessionHost& host, std::uint64_t number)
    : snapshots{*host.clock, host.traffic.snapshots_dropped, *this}
    , transport_{std::move(transport)}
    , host_{host}
    , number_{number}
    , peer_{transport_->peer()}
    , address_prefix_{address_key(peer_.address())}
    , reader_bytes_{host.send_memory}
    , expected_bytes_{host.send_memory}
    , held_back_bytes_{host.send_memory}
    , turns_to_send_{requests_per_s_max, request_burst_max, host.clock->now()}
    , empty_frames_{empty_frames_per_s_max, empty_frames_burst_max, host.clock->now()}
    , hello_timer_{transport_->socket().get_executor()}
    , frame_timer_{transport_->socket().get_executor()}
    , turn_timer_{transport_->socket().get_executor()}
    , farewell_timer_{transport_->socket().get_executor()}
    , writer_signal_{transport_->socket().get_executor(), asio::steady_timer::time_point::max()} {
    boost::system::error_code ignored; // if an option cannot be set, the session still works, but less well
    transport_->socket().set_option(tcp::no_delay{true}, ignored);
    transport_->socket().set_option(asio::socket_base::keep_alive{true}, ignored);
    const auto set = [&](int option, std::int64_t value) {
        const int given = static_cast<int>(value);
        ::setsockopt(transport_->socket().native_handle(), IPPROTO_TCP, option, &given, sizeof given);
    };
    set(TCP_NOTSENT_LOWAT, unsent_bytes_max);
    set(TCP_KEEPIDLE, silence_max.count());
    set(TCP_KEEPINTVL, probe_every.count());
    set(TCP_KEEPCNT, probes_max);
    set(TCP_USER_TIMEOUT, untaken_max.count());
}

void Session::start(const std::optional<base::Refusal>& refused) {
    coroutines_ = 2;
    asio::co_spawn(
        transport_->socket().get_executor(), [self = shared_from_this()] { return self->read(); }, detached);
    asio::co_spawn(
        transport_->socket().get_executor(), [self = shared_from_this()] { return self->write(); }, detached);
    if (refused) {
        fail(*refused);
        return;
    }
    hello_timer_.expires_after(hello_timeout);
    hello_timer_.async_wait([weak = weak_from_this()](boost::system::error_code error) {
        if (const auto self = weak.lock(); self && !error && !self->greeted_) {
            self->host_.limit_counters.met(Limit::HelloTimeout);
            self->fail(refusal(base::RefusalCode::FailedPrecondition,
                               "no Hello was received within " + std::to_string(hello_timeout.count()) +
                                   " s: connect again and send one first",
                               base::Reason::HelloMissing));
            if (!self->begun_) {
                self->close(); // the TLS handshake is not complete, so a Goodbye cannot be sent
            }
        }
    });
}

std::uint32_t Session::control_frame_bytes_max() const {
    const std::uint32_t most = host_.limits.control_frame_bytes_max();
    return visitor_.role < access::Role::Admin ? std::min(most, frame_bytes_max_below_admin) : most;
}

v1::Limits Session::limits() const {
    v1::Limits limits = host_.limits;
    limits.set_control_frame_bytes_max(control_frame_bytes_max());
    return limits;
}

std::string Session::by() const {
    return (visitor_.name.empty() ? "" : visitor_.name + ": ") + client_ + " " + to_text(peer_);
}

// ---- reading ---------------------------------------------------------------------------------------------------

asio::awaitable<void> Session::read() {
    std::array<std::byte, 16384> bytes;
    if (const auto error = co_await transport_->begin(); error == Transport::not_tls()) {
        fail(refusal(base::RefusalCode::FailedPrecondition,
                     "this server requires TLS: use --ca FILE or --tls with evoctl and evoview",
                     base::Reason::TlsRequired));
    } else if (error) {
        if (!ended_) { // if the session has ended, the reason is already logged
            log_closed({}, "TLS: " + error.message());
        }
        close();
    }
    begun_ = true;
    wake_writer();
    while (!finishing_ && !ended_) {
        reading_ = true;
        const auto [error, count] = co_await transport_->read_some(asio::buffer(bytes));
        reading_ = false;
        silent_ = {};
        const bool more_to_say = in_flight_ + queue_.size() + sending_.size() > 0;
        if (error == asio::error::eof && (finishing_ || more_to_say || transport_->is_websocket()) && !ended_) {
            // The client closed its sending side but may still read. It therefore receives the pending answers, and in a
            // WebSocket a Close frame.
            input_over_ = true;
            wake_writer();
            end();
            co_return;
        }
        if (error == Transport::websocket_fault() && !finishing_ && !ended_) {
            const WebSocketDecoder::Fault fault = *transport_->fault();
            close_code_ = fault.code;
            co_await fail_when_answered(
                refusal(base::RefusalCode::InvalidArgument, std::string{fault.what}, base::Reason::FrameInvalid));
            break;
        }
        if (error || ended_) {
            break;
        }
        count_empty_frames();
        host_.traffic.received_bytes.add(count);
        reader_.feed({bytes.data(), count});
        reader_bytes_.set(reader_.capacity_bytes());
        while (!finishing_ && !ended_) {
            const auto frame = reader_.next();
            if (!frame) {
                if (frame.error().exceeded == codec::ExceededLimit::FrameBytes) {
                    close_code_ = WebSocketClose::MessageTooBig;
                    host_.limit_counters.met(greeted_ ? Limit::ControlFrameBytes : Limit::HelloFrameBytes);
                }
                co_await fail_when_answered(
                    refusal(base::RefusalCode::InvalidArgument, frame.error().what, base::Reason::FrameInvalid));
                break;
            }
            if (!*frame) {
                break;
            }
            within_frame_ = false; // the time limit of a frame does not apply while the session does not read
            frame_timer_.cancel();
            const double cost = 1 + std::floor(static_cast<double>((*frame)->body.size()) / bytes_per_turn);
            if (!turns_to_send_.take(cost, host_.clock->now())) {
                co_await wait_for_turn(cost);
            }
            if (finishing_ || ended_) {
                break;
            }
            on_frame(**frame);
            // Let the thread serve other sessions before the next frame is read.
            co_await asio::post(transport_->socket().get_executor(), no_throw);
        }
        update_frame_timer();
        reader_.trim();
        reader_bytes_.set(ended_ ? 0 : reader_.capacity_bytes());
    }
    if (finishing_ && !ended_) {
        co_await discard_input();
    } else {
        close();
    }
    end();
}

void Session::count_empty_frames() {
    const std::uint64_t count = transport_->take_empty_frame_count();
    if (transport_->control_waits()) {
        wake_writer();
    }
    if (count > 0 && !empty_frames_.take(static_cast<double>(count), host_.clock->now())) {
        host_.limit_counters.met(Limit::RequestsPerSecond);
        host_.limit_counters.met(Limit::RequestBurst);
        fail(refusal(base::RefusalCode::ResourceExhausted,
                     "got more than " + std::to_string(static_cast<int>(empty_frames_per_s_max)) +
                         " pings, pongs and empty messages per second: send fewer",
                     base::Reason::Unspecified));
    }
}

void Session::update_frame_timer() {
    const bool within = reader_.buffered_bytes() > 0 && !finishing_ && !ended_;
    const bool goes_on = within && within_frame_;
    within_frame_ = within;
    if (goes_on) {
        return;
    }
    frame_timer_.cancel();
    if (!within) {
        return;
    }
    frame_timer_.expires_after(frame_timeout);
    frame_timer_.async_wait([weak = weak_from_this()](boost::system::error_code error) {
        // The frame may have arrived after the timer expired, but before this handler.
        if (const auto self = weak.lock(); self && !error && self->within_frame_) {
            self->host_.limit_counters.met(Limit::FrameTimeout);
            self->fail(refusal(base::RefusalCode::FailedPrecondition,
                               "a frame did not arrive completely within " + std::to_string(frame_timeout.count()) +
                                   " s: connect again and send each frame without pauses",
                               base::Reason::FrameLate));
        }
    });
}

asio::awaitable<void> Session::wait_for_turn(double cost) {
    host_.limit_counters.met(Limit::RequestsPerSecond);
    host_.limit_counters.met(Limit::RequestBurst);
    do {
        turn_timer_.expires_after(turns_to_send_.time_for(request_burst_max / 10));
        co_await turn_timer_.async_wait(no_throw);
    } while (!finishing_ && !ended_ && !turns_to_send_.take(cost, host_.clock->now()));
}

asio::awaitable<void> Session::fail_when_answered(base::Refusal refused) {
    if (in_flight_ > 0) {
        input_over_ = true;
        within_frame_ = false;
        frame_timer_.cancel();
        wake_writer();
        turn_timer_.expires_at(asio::steady_timer::time_point::max());
        co_await turn_timer_.async_wait(no_throw);
    }
    fail(refused);
}

/// Reads and discards further input. If unread bytes remained, closing the connection would discard the last answer. The
/// frames of a WebSocket are not decoded, so that neither a ping nor an invalid frame ends this.
asio::awaitable<void> Session::discard_input() {
    std::array<std::byte, 16384> bytes;
    boost::system::error_code error;
    while (!error) {
        std::tie(error, std::ignore) = co_await transport_->receive_some(asio::buffer(bytes));
    }
    if (error != asio::error::eof) { // otherwise the client may still read
        close();
    }
}

void Session::on_frame(const codec::Frame& frame) {
    auto message = codec::parse_body<v1::ClientMessage>(frame.body);
    if (!message && message.error().exceeded == codec::ExceededLimit::MessageDepth) {
        host_.limit_counters.met(Limit::MessageDepth);
    }
    if (!greeted_) {
        if (!message) {
            return fail(
                refusal(base::RefusalCode::InvalidArgument, message.error().what, base::Reason::MessageUnreadable));
        }
        if (!message->has_hello()) {
            return fail(refusal(base::RefusalCode::FailedPrecondition, "the first message must be a Hello",
                                base::Reason::HelloMissing));
        }
        return on_hello(message->hello());
    }
    if (!message) {
        return send_unasked(protocol::refusing(
            0, refusal(base::RefusalCode::InvalidArgument, message.error().what, base::Reason::MessageUnreadable)));
    }
    switch (message->kind_case()) {
    case v1::ClientMessage::kRequest:
        host_.traffic.requests.add();
        host_.handle(*this, std::move(*message->mutable_request()));
        break;
    case v1::ClientMessage::kAcknowledgeSnapshot:
        snapshots.acknowledge(message->acknowledge_snapshot());
        break;
    case v1::ClientMessage::kHello:
        send_unasked(protocol::refusing(0, refusal(base::RefusalCode::FailedPrecondition,
                                                   "this session has received its Hello already: send requests",
                                                   base::Reason::HelloRepeated)));
        break;
    case v1::ClientMessage::KIND_NOT_SET:
        send_unasked(protocol::refusing(0, refusal(base::RefusalCode::Unimplemented,
                                                   "this server does not know the message: it may be older than "
                                                   "the client; Describe lists what it knows",
                                                   base::Reason::RequestUnknown)));
        break;
    }
}

void Session::on_hello(const v1::Hello& hello) {
    if (const auto refused = protocol::refusal_of(hello)) {
        return fail(*refused);
    }
    auto visitor = host_.admit(hello.token(), address_prefix_);
    if (!visitor) {
        return fail(visitor.error());
    }
    visitor_ = *std::move(visitor);
    greeted_ = true;
    if (hello.frame_bytes_max() != 0) {
        frame_bytes_max_ = hello.frame_bytes_max();
        snapshots.set_frame_bytes_max(frame_bytes_max_);
    }
    hello_timer_.cancel();
    reader_.set_limits({.control_bytes_max = control_frame_bytes_max(), .stream_bytes_max = std::nullopt});
    client_ = protocol::client_name_of(hello);
    log_connection("connected as " + std::string{access::name_of(visitor_.role)} + ", version " +
                   (hello.client_version().empty() ? "unknown" : protocol::quotable(hello.client_version())));

    v1::ServerMessage message;
    v1::Welcome& welcome = *message.mutable_welcome();
    welcome.set_protocol_version(codec::protocol_version);
    welcome.set_server_version(EVOD_VERSION);
    welcome.set_instance_id(host_.instance_id);
    for (const char* feature : {"codec:plain", "codec:delta", "compression:zstd", "acknowledgements", "view",
                                "planned_changes", "place", "fitness"}) {
        welcome.add_features(feature);
    }
    *welcome.mutable_limits() = limits();
    welcome.set_durability(host_.durability);
    if (host_.storage) {
        *welcome.mutable_storage() = *host_.storage;
    }
    welcome.set_role(access::to_proto(visitor_.role));
    welcome.set_user(visitor_.name);
    if (!host_.page.is_local || peer_.address().is_loopback()) {
        welcome.set_page_port(host_.page.port);
        welcome.set_page_host(host_.page.host);
    }
    enqueue(encode_control(message), Kind::Unasked);
}

void Session::log_connection(const std::string& what) const {
    // Every call of evoctl opens a session, usually on the server's own machine. Such sessions are logged only at
    // Debug.
    const auto level = peer_.address().is_loopback() ? log::Level::Debug : log::Level::Info;
    if (log::wanted(level)) {
        log::write(level, {.session = number_, .client = by()},
                   "session " + std::to_string(number_) + ": " + by() + " " + what);
    }
}

void Session::log_closed(std::string_view code, const std::string& why) {
    const std::string who = greeted_ ? by() : to_text(peer_);
    std::string left_out;
    if (!greeted_) { // connections without a Hello must not fill the disk with log lines
        SessionHost::UngreetedLog& ungreeted = host_.ungreeted_log;
        const auto now = host_.clock->now();
        if (!ungreeted.lines) {
            ungreeted.lines.emplace(ungreeted_lines_per_s, ungreeted_lines_burst, now);
        }
        if (!ungreeted.lines->take(1, now)) {
            ++ungreeted.left_out;
            return;
        }
        if (ungreeted.left_out > 0) {
            left_out =
                "; " + std::to_string(std::exchange(ungreeted.left_out, 0)) + " earlier connections were not logged";
        }
    }
    log::info({.session = number_, .client = who, .code = std::string{code}}, "session {}: {} closed: {}{}", number_,
              who, why, left_out);
}

void Session::fail(const base::Refusal& refused) {
    if (finishing_ || ended_) {
        return;
    }
    log_closed(name_of(refused.code), refused.message);
    enqueue(encode_goodbye(refused), Kind::Unasked);
    if (!close_code_) {
        close_code_ = refused.reason == base::Reason::ServerGoingAway ? WebSocketClose::GoingAway
                                                                      : WebSocketClose::PolicyViolation;
    }
    finish();
}

// ---- closing ---------------------------------------------------------------------------------------------------

void Session::check_progress(runtime::Clock::duration watched) {
    const Transport::Progress progress = sending_.empty() ? Transport::Progress{} : transport_->progress();
    if (sending_.empty() || ended_ || progress != progress_) {
        progress_ = progress;
        stalled_ = {};
    } else if (stalled_ += watched; stalled_ >= stalled_timeout) {
        host_.limit_counters.met(Limit::StalledTimeout);
        log::warn({.session = number_, .client = by()},
                  "session {}: {} closed: the client has received nothing for {} s", number_, by(),
                  stalled_timeout.count());
        close();
    }
    if (transport_->is_websocket()) {
        check_silence(watched);
    }
}

void Session::check_silence(runtime::Clock::duration watched) {
    // Silence counts only while this session reads, and while the client has received everything. Otherwise the rate
    // limit or stalled_timeout apply.
    if (!reading_ || finishing_ || ended_ || !sending_.empty() || transport_->progress().not_taken > 0) {
        return;
    }
    const auto before = std::exchange(silent_, silent_ + watched);
    if (before < websocket_ping_after && silent_ >= websocket_ping_after) {
        transport_->ping();
        wake_writer();
    } else if (silent_ >= websocket_silence_max) {
        log_closed({}, "the client has not answered a ping for " +
                           std::to_string((websocket_silence_max - websocket_ping_after).count()) + " s");
        close();
    }
}

std::size_t Session::held_bytes() const {
    std::size_t bytes = reader_bytes_.bytes() + expected_bytes_.bytes() + held_back_bytes_.bytes();
    for (const Queued& queued : queue_) {
        bytes += queued.bytes.share();
    }
    for (const Queued& queued : sending_) {
        bytes += queued.bytes.share();
    }
    return bytes;
}

void Session::evict() {
    host_.limit_counters.met(Limit::ClientBufferBytes);
    log::warn({.session = number_, .client = by()},
              "session {}: {} closed: all sessions use more than {} MiB of memory, and this one uses {} KiB", number_,
              by(), client_buffer_bytes_max >> 20, held_bytes() >> 10);
    close();
}

void Session::finish() {
    if (finishing_ || ended_) {
        return;
    }
    finishing_ = true;
    snapshots.stop();
    hello_timer_.cancel();
    turn_timer_.cancel();
    farewell_timer_.expires_after(farewell_timeout);
    farewell_timer_.async_wait([weak = weak_from_this()](boost::system::error_code error) {
        if (const auto self = weak.lock(); self && !error) {
            self->close();
        }
    });
    wake_writer();
}

void Session::close() {
    if (std::exchange(ended_, true)) {
        return;
    }
    if (sending_.empty()) {
        transport_->close();
    } else {
        transport_->abort();
    }
    hello_timer_.cancel();
    frame_timer_.cancel();
    turn_timer_.cancel();
    farewell_timer_.cancel();
    // sending_ is kept until the current write has ended.
    queue_.clear();
    snapshots.clear();
    reader_bytes_.set(0);
    expected_bytes_.set(0);
    held_back_.clear();
    held_back_bytes_.set(0);
    wake_writer();
}

void Session::end() {
    if (--coroutines_ > 0) {
        return;
    }
    if (greeted_) {
        log_connection("disconnected");
    }
    host_.ended(*this);
}

} // namespace evod::network
