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

std::string account_of(const std::string& user, const std::string& address_prefix) {
    return user.empty() ? "@" + address_prefix : user; // no token's name contains an @
}

Session::Session(tcp::socket socket, SessionHost& host, std::uint64_t number)
    : Session{std::make_unique<Transport>(std::move(socket), host.tls), host, number} {}

Session::Session(std::unique_ptr<Transport> transport, SessionHost& host, std::uint64_t number)
    : snapshots{*host.clock, host.traffic.snapshots_dropped, *this}
    , requests{host.send_memory}
    , transport_{std::move(transport)}
    , host_{host}
    , number_{number}
    , peer_{transport_->peer()}
    , address_prefix_{address_key(peer_.address())}
    , account_{account_of({}, address_prefix_)}
    , deadline_timer_{transport_->socket().get_executor()}
    , reader_bytes_{host.send_memory}
    , subscription_bytes_{host.send_memory}
    , replay_bytes_{host.send_memory}
    , rate_limit_{requests_per_s_max, request_burst_max, host.clock->now()}
    , empty_frame_limit_{empty_frames_per_s_max, empty_frames_burst_max, host.clock->now()}
    , turn_{transport_->socket().get_executor()}
    , queue_{host.send_memory}
    , writer_{transport_->socket().get_executor()} {
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
    coroutines_ = 1;
    asio::co_spawn(
        transport_->socket().get_executor(), [self = shared_from_this()] { return self->read(); }, detached);
    if (refused) {
        fail(*refused);
    } else {
        begin(Deadline::Hello, hello_timeout);
    }
}

// ---- deadlines -------------------------------------------------------------------------------------------------

void Session::begin(Deadline deadline, std::chrono::seconds time) {
    deadline_ = deadline;
    deadline_timer_.expires_after(time);
    deadline_timer_.async_wait(
        [weak = weak_from_this(), deadline, at = deadline_timer_.expiry()](boost::system::error_code error) {
            // The deadline may have ended after the timer expired, but before this handler.
            if (const auto self = weak.lock();
                self && !error && self->deadline_ == deadline && self->deadline_timer_.expiry() == at) {
                self->deadline_ = Deadline::None;
                self->on_missed(deadline);
            }
        });
}

void Session::end(Deadline deadline) {
    if (deadline_ == deadline) {
        deadline_ = Deadline::None;
        deadline_timer_.cancel();
    }
}

void Session::on_missed(Deadline deadline) {
    switch (deadline) {
    case Deadline::None:
        return;
    case Deadline::Hello: {
        host_.limit_counters.met(Limit::HelloTimeout);
        const bool is_connecting = phase_ == Phase::Connecting;
        fail(refusal(base::RefusalCode::FailedPrecondition,
                     "no Hello was received within " + std::to_string(hello_timeout.count()) +
                         " s: connect again and send one first",
                     base::Reason::HelloMissing));
        if (is_connecting) {
            close(); // the TLS handshake is not complete, so a Goodbye cannot be sent
        }
        return;
    }
    case Deadline::Frame:
        host_.limit_counters.met(Limit::FrameTimeout);
        return fail(refusal(base::RefusalCode::FailedPrecondition,
                            "a frame did not arrive completely within " + std::to_string(frame_timeout.count()) +
                                " s: connect again and send each frame without pauses",
                            base::Reason::FrameLate));
    case Deadline::Answers:
        host_.limit_counters.met(Limit::AnswersTimeout);
        if (turn_.is_awaited()) {
            return turn_.notify(); // fail_when_answered() continues
        }
        log_closed({}, "the client has closed its sending side, and its requests were not answered within " +
                           std::to_string(answers_timeout.count()) + " s");
        return close();
    case Deadline::Farewell:
        return close();
    }
}

void Session::update_frame_deadline() {
    if (reader_.buffered_bytes() == 0 || is_over()) {
        end(Deadline::Frame);
    } else if (deadline_ == Deadline::None) {
        begin(Deadline::Frame, frame_timeout);
    }
}

// ---- the client ------------------------------------------------------------------------------------------------

std::uint32_t Session::control_frame_bytes_max() const {
    const std::uint32_t most = host_.limits.control_frame_bytes_max();
    return user_->role < access::Role::Admin ? std::min(most, frame_bytes_max_below_admin) : most;
}

v1::Limits Session::limits() const {
    v1::Limits limits = host_.limits;
    limits.set_control_frame_bytes_max(control_frame_bytes_max());
    return limits;
}

base::Actor Session::actor() const {
    return base::client_actor(user_ ? user_->name : "", client_, to_text(peer_));
}

// ---- reading ---------------------------------------------------------------------------------------------------

asio::awaitable<void> Session::read() {
    std::array<std::byte, 16384> bytes;
    if (const auto error = co_await transport_->begin(); error == Transport::not_tls()) {
        fail(refusal(base::RefusalCode::FailedPrecondition,
                     "this server requires TLS: use --ca FILE or --tls with evoctl and evoview",
                     base::Reason::TlsRequired));
    } else if (error) {
        if (phase_ != Phase::Ended) { // otherwise the reason is already logged
            log_closed({}, "TLS: " + error.message());
        }
        close();
    }
    if (phase_ == Phase::Connecting) {
        phase_ = Phase::Open;
    }
    if (phase_ != Phase::Ended) {
        ++coroutines_;
        asio::co_spawn(
            transport_->socket().get_executor(), [self = shared_from_this()] { return self->write(); }, detached);
    }
    while (!is_over()) {
        watch_.begin_read();
        const auto [error, count] = co_await transport_->read_some(asio::buffer(bytes));
        watch_.end_read();
        const bool more_to_say = requests.unanswered() > 0 || queue_.has_waiting_frames() || queue_.is_sending();
        if (error == asio::error::eof && phase_ != Phase::Ended &&
            (phase_ == Phase::Finishing || more_to_say || transport_->is_websocket())) {
            // The client closed its sending side but may still read. It therefore receives the answers that come soon,
            // and in a WebSocket a Close frame.
            if (phase_ == Phase::Finishing) {
                close_code_ = close_code_.value_or(WebSocketClose::Normal);
            } else {
                phase_ = Phase::InputOver;
                begin(Deadline::Answers, answers_timeout);
            }
            writer_.notify();
            end_coroutine();
            co_return;
        }
        if (error == Transport::websocket_fault() && !is_over()) {
            const WebSocketDecoder::Fault fault = *transport_->fault();
            close_code_ = fault.code;
            co_await fail_when_answered(
                refusal(base::RefusalCode::InvalidArgument, std::string{fault.what}, base::Reason::FrameInvalid));
            break;
        }
        if (error || phase_ == Phase::Ended) {
            break;
        }
        count_empty_frames();
        host_.traffic.received_bytes.add(count);
        reader_.feed({bytes.data(), count});
        reader_bytes_.set(reader_.capacity_bytes());
        while (!is_over()) {
            const auto frame = reader_.next();
            if (!frame) {
                if (frame.error().exceeded == codec::ExceededLimit::FrameBytes) {
                    close_code_ = WebSocketClose::MessageTooBig;
                    host_.limit_counters.met(greeted() ? Limit::ControlFrameBytes : Limit::HelloFrameBytes);
                }
                co_await fail_when_answered(
                    refusal(base::RefusalCode::InvalidArgument, frame.error().what, base::Reason::FrameInvalid));
                break;
            }
            if (!*frame) {
                break;
            }
            end(Deadline::Frame); // the time limit of a frame does not apply while the session does not read
            const double cost = 1 + std::floor(static_cast<double>((*frame)->body.size()) / bytes_per_turn);
            if (!rate_limit_.take(cost, host_.clock->now())) {
                co_await wait_for_rate_limit(cost);
            }
            const bool is_large = LargeFrames::contains((*frame)->body.size());
            if (is_large) {
                co_await wait_for_large_frame();
            }
            if (is_over()) {
                break;
            }
            const auto began = host_.clock->now();
            on_frame(**frame);
            if (is_large) {
                host_.large_frames.charge(account_, host_.clock->now(), host_.clock->now() - began);
            }
            // Let the thread serve other sessions before the next frame is read.
            co_await asio::post(transport_->socket().get_executor(), no_throw);
        }
        update_frame_deadline();
        reader_.trim();
        reader_bytes_.set(phase_ == Phase::Ended ? 0 : reader_.capacity_bytes());
    }
    if (phase_ == Phase::Finishing) {
        co_await discard_input();
    } else {
        close();
    }
    end_coroutine();
}

void Session::count_empty_frames() {
    const std::uint64_t count = transport_->take_empty_frame_count();
    if (transport_->control_waits()) {
        writer_.notify();
    }
    if (count > 0 && !empty_frame_limit_.take(static_cast<double>(count), host_.clock->now())) {
        host_.limit_counters.met(Limit::RequestsPerSecond);
        host_.limit_counters.met(Limit::RequestBurst);
        fail(refusal(base::RefusalCode::ResourceExhausted,
                     "got more than " + std::to_string(static_cast<int>(empty_frames_per_s_max)) +
                         " pings, pongs and empty messages per second: send fewer",
                     base::Reason::Unspecified));
    }
}

asio::awaitable<void> Session::wait_for_rate_limit(double cost) {
    host_.limit_counters.met(Limit::RequestsPerSecond);
    host_.limit_counters.met(Limit::RequestBurst);
    do {
        co_await turn_.wait(Signal::Timer::clock_type::now() + rate_limit_.time_for(request_burst_max / 10));
    } while (!is_over() && !rate_limit_.take(cost, host_.clock->now()));
}

asio::awaitable<void> Session::wait_for_large_frame() {
    // Another session of the user may have parsed one when this session wakes up.
    for (auto now = host_.clock->now(), earliest = host_.large_frames.earliest(account_); !is_over() && earliest > now;
         now = host_.clock->now(), earliest = host_.large_frames.earliest(account_)) {
        co_await turn_.wait(Signal::Timer::clock_type::now() + (earliest - now));
    }
}

asio::awaitable<void> Session::fail_when_answered(base::Refusal refused) {
    if (requests.unanswered() > 0) {
        phase_ = Phase::InputOver;
        begin(Deadline::Answers, answers_timeout);
        writer_.notify();
        co_await turn_.wait();
    }
    fail(refused);
}

/// Reads and discards further input. If unread bytes remained, closing the connection would discard the last answer.
/// The frames of a WebSocket are not decoded, so that neither a ping nor an invalid frame ends this.
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
    if (!greeted()) {
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
    const auto member = host_.admit_member(hello);
    if (member && !*member) {
        return fail(member->error());
    }
    auto user = member ? (*member)->user : host_.admit(hello.token(), address_prefix_);
    if (!user) {
        return fail(user.error());
    }
    const std::string account = account_of(user->name, address_prefix_);
    if (const auto refused = host_.make_room(account)) {
        return fail(*refused);
    }
    account_ = account;
    user_ = *std::move(user);
    if (hello.frame_bytes_max() != 0) {
        queue_.set_frame_bytes_max(hello.frame_bytes_max());
        snapshots.set_frame_bytes_max(hello.frame_bytes_max());
    }
    end(Deadline::Hello);
    reader_.set_limits({.control_bytes_max = control_frame_bytes_max(), .stream_bytes_max = std::nullopt});
    client_ = protocol::client_name_of(hello);
    log_connection("connected as " + std::string{access::name_of(user_->role)} + ", version " +
                   (hello.client_version().empty() ? "unknown" : protocol::quotable(hello.client_version())));

    v1::ServerMessage message;
    v1::Welcome& welcome = *message.mutable_welcome();
    welcome.set_protocol_version(codec::protocol_version);
    welcome.set_server_version(EVOD_VERSION);
    welcome.set_instance_id(host_.instance_id);
    for (const char* feature : {"codec:plain", "codec:delta", "compression:zstd", "acknowledgements", "view",
                                "planned_changes", "place", "fitness", "classes"}) {
        welcome.add_features(feature);
    }
    *welcome.mutable_limits() = limits();
    welcome.set_durability(host_.durability);
    if (host_.storage) {
        *welcome.mutable_storage() = *host_.storage;
    }
    welcome.set_role(access::to_proto(user_->role));
    welcome.set_user(user_->name);
    if (member) {
        *welcome.mutable_membership() = (*member)->membership;
    }
    if (!host_.page.is_local || peer_.address().is_loopback()) {
        welcome.set_page_port(host_.page.port);
        welcome.set_page_host(host_.page.host);
    }
    enqueue(encode_control(message), Kind::Unasked);
}

void Session::log_connection(const std::string& what) const {
    // Every call of evoctl opens a session, usually on the server's own machine. Such sessions are logged only at
    // Debug.
    log_line(peer_.address().is_loopback() ? log::Level::Debug : log::Level::Info, {}, what);
}

void Session::log_line(log::Level level, std::string_view code, const std::string& what) const {
    if (!log::wanted(level)) {
        return;
    }
    std::uint64_t left_out = 0;
    if (level >= log::Level::Info) { // clients must not fill the disk with log lines
        const auto before = host_.log_limit.take(greeted() ? account_ : "", host_.clock->now());
        if (!before) {
            return;
        }
        left_out = *before;
    }
    const std::string who = greeted() ? by() : to_text(peer_);
    log::write(level, {.session = number_, .client = who, .code = std::string{code}},
               "session " + std::to_string(number_) + ": " + who + " " + what +
                   (left_out == 0 ? ""
                                  : "; " + std::to_string(left_out) + " earlier " +
                                        (greeted() ? "lines about this user" : "connections") + " were not logged"));
}

void Session::log_closed(std::string_view code, const std::string& why) {
    log_line(log::Level::Info, code, "closed: " + why);
}

void Session::fail(const base::Refusal& refused) {
    if (is_over()) {
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
    const bool sends = queue_.is_sending() && phase_ != Phase::Ended;
    if (watch_.is_stalled(sends ? std::optional{transport_->progress()} : std::nullopt, watched)) {
        host_.limit_counters.met(Limit::StalledTimeout);
        log_line(log::Level::Warn, {},
                 "closed: the client has received nothing for " + std::to_string(stalled_timeout.count()) + " s");
        close();
    }
    if (transport_->is_websocket()) {
        check_silence(watched);
    }
}

void Session::check_silence(runtime::Clock::duration watched) {
    // Silence counts only while this session reads, and while the client has received everything. Otherwise the rate
    // limit or stalled_timeout apply.
    if (is_over() || queue_.is_sending() || transport_->progress().not_taken > 0) {
        return;
    }
    switch (watch_.silence_after(watched)) {
    case ClientWatch::Silence::Short:
        return;
    case ClientWatch::Silence::PingDue:
        transport_->ping();
        return writer_.notify();
    case ClientWatch::Silence::TooLong:
        log_closed({}, "the client has not answered a ping for " +
                           std::to_string((websocket_silence_max - websocket_ping_after).count()) + " s");
        return close();
    }
}

std::size_t Session::held_bytes() const {
    return reader_bytes_.bytes() + requests.held_bytes() + queue_.held_bytes() + subscription_bytes_.bytes() +
           replay_bytes_.bytes();
}

void Session::evict(std::string_view why, std::size_t bytes) {
    host_.limit_counters.met(Limit::ClientBufferBytes);
    log_line(log::Level::Warn, {},
             "closed: " + std::string{why} + " of memory, and this one uses " + std::to_string(bytes >> 10) + " KiB");
    close();
}

void Session::finish() {
    if (is_over()) {
        return;
    }
    if (phase_ == Phase::InputOver && !close_code_) {
        close_code_ = WebSocketClose::Normal;
    }
    phase_ = Phase::Finishing;
    snapshots.stop();
    begin(Deadline::Farewell, farewell_timeout);
    turn_.notify();
    writer_.notify();
}

void Session::close() {
    if (std::exchange(phase_, Phase::Ended) == Phase::Ended) {
        return;
    }
    if (queue_.is_sending()) {
        transport_->abort();
    } else {
        transport_->close();
    }
    end(deadline_);
    queue_.drop_waiting();
    snapshots.clear();
    count_subscriptions();
    reader_bytes_.set(0);
    replay_bytes_.set(0); // the thread of the replays releases them soon
    requests.close();
    turn_.notify();
    writer_.notify();
}

void Session::end_coroutine() {
    if (--coroutines_ > 0) {
        return;
    }
    if (greeted()) {
        log_connection("disconnected");
    }
    host_.ended(*this);
}

} // namespace evod::network
