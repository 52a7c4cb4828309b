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
#include <utility>
#include <vector>

namespace evod::network {
namespace {

constexpr std::size_t batch_frames_max = 64;
constexpr std::size_t snapshots_at_once = 32; // snapshots that one session sends before other sessions are served
// send_frame() copies a frame into one buffer if it has many parts or is short.
constexpr std::size_t gathered_parts_max = 12, gathered_bytes_min = 32 << 10;
static_assert(gathered_parts_max + 2 <= Transport::buffers_at_once, "there are a header and a tail, too");

} // namespace

Session::Session(tcp::socket socket, SessionHost& host, std::uint64_t number)
    : snapshots{*host.clock, host.traffic.snapshots_dropped, *this}
    , transport_{std::move(socket), host.tls}
    , host_{host}
    , number_{number}
    , peer_{transport_.peer()}
    , address_prefix_{address_key(peer_.address())}
    , reader_bytes_{host.send_memory}
    , expected_bytes_{host.send_memory}
    , held_back_bytes_{host.send_memory}
    , turns_to_send_{requests_per_s_max, request_burst_max, host.clock->now()}
    , hello_timer_{transport_.socket().get_executor()}
    , frame_timer_{transport_.socket().get_executor()}
    , turn_timer_{transport_.socket().get_executor()}
    , farewell_timer_{transport_.socket().get_executor()}
    , writer_signal_{transport_.socket().get_executor(), asio::steady_timer::time_point::max()} {
    boost::system::error_code ignored; // if an option cannot be set, the session still works, but less well
    transport_.socket().set_option(tcp::no_delay{true}, ignored);
    transport_.socket().set_option(asio::socket_base::keep_alive{true}, ignored);
    const auto set = [&](int option, std::int64_t value) {
        const int given = static_cast<int>(value);
        ::setsockopt(transport_.socket().native_handle(), IPPROTO_TCP, option, &given, sizeof given);
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
        transport_.socket().get_executor(), [self = shared_from_this()] { return self->read(); }, detached);
    asio::co_spawn(
        transport_.socket().get_executor(), [self = shared_from_this()] { return self->write(); }, detached);
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
    if (const auto error = co_await transport_.begin(); error == Transport::not_tls()) {
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
        const auto [error, count] = co_await transport_.read_some(asio::buffer(bytes));
        const bool more_to_say = in_flight_ + queue_.size() + sending_.size() > 0;
        if (error == asio::error::eof && more_to_say && !finishing_ && !ended_) {
            // The client closed its sending side but may still read. It therefore receives the pending answers.
            input_over_ = true;
            wake_writer();
            end();
            co_return;
        }
        if (error || ended_) {
            break;
        }
        host_.traffic.received_bytes.add(count);
        reader_.feed({bytes.data(), count});
        reader_bytes_.set(reader_.capacity_bytes());
        bool one_came = false;
        while (!finishing_ && !ended_) {
            const auto frame = reader_.next();
            if (!frame) {
                if (frame.error().exceeded == codec::ExceededLimit::FrameBytes) {
                    host_.limit_counters.met(greeted_ ? Limit::ControlFrameBytes : Limit::HelloFrameBytes);
                }
                co_await fail_when_answered(
                    refusal(base::RefusalCode::InvalidArgument, frame.error().what, base::Reason::FrameInvalid));
                break;
            }
            if (!*frame) {
                break;
            }
            one_came = true;
            const double cost = 1 + std::floor(static_cast<double>((*frame)->body.size()) / bytes_per_turn);
            if (!turns_to_send_.take(cost, host_.clock->now())) {
                co_await wait_for_turn(cost);
            }
            if (finishing_ || ended_) {
                break;
            }
            on_frame(**frame);
            // Let the thread serve other sessions before the next frame is read.
            co_await asio::post(transport_.socket().get_executor(), no_throw);
        }
        update_frame_timer(one_came);
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

void Session::update_frame_timer(bool one_came) {
    const bool within = reader_.buffered_bytes() > 0 && !finishing_ && !ended_;
    const bool goes_on = within && within_frame_ && !one_came;
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
        if (const auto self = weak.lock(); self && !error) {
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
    // The time limit of a frame does not apply while the session does not read.
    within_frame_ = false;
    frame_timer_.cancel();
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

/// Reads and discards further input. If unread bytes remained, closing the connection would discard the last answer.
asio::awaitable<void> Session::discard_input() {
    std::array<std::byte, 16384> bytes;
    for (;;) {
        const auto [error, count] = co_await transport_.read_some(asio::buffer(bytes));
        if (error) {
            break;
        }
    }
    close();
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
    finish();
}

// ---- sending ---------------------------------------------------------------------------------------------------

bool Session::admit_request() {
    if (in_flight_ >= requests_in_flight_max) {
        host_.limit_counters.met(Limit::RequestsInFlight);
        return false;
    }
    ++in_flight_;
    return true;
}

void Session::hold_back(v1::Request request) {
    const std::size_t bytes = request.SpaceUsedLong();
    held_back_bytes_.set(held_back_bytes_.bytes() + bytes);
    held_back_.push_back({std::move(request), bytes});
}

std::optional<v1::Request> Session::take_held_back() {
    if (held_back_.empty()) {
        return std::nullopt;
    }
    HeldBack next = std::move(held_back_.front());
    held_back_.pop_front();
    held_back_bytes_.set(held_back_bytes_.bytes() - next.bytes);
    return std::move(next.request);
}

void Session::expect(std::ptrdiff_t bytes) {
    if (!ended_) {
        expected_bytes_.set(expected_bytes_.bytes() + static_cast<std::size_t>(bytes));
    }
}

void Session::answer(SharedBytes frame) {
    turns_to_send_.charge(static_cast<double>(frame->size() / answer_bytes_per_turn));
    if (takes(frame->size())) {
        return enqueue(std::move(frame), Kind::Answer);
    }
    v1::ServerMessage too_large;
    too_large.ParseFromString(frame->substr(codec::header_bytes));
    enqueue(encode_response(
                protocol::refusing(too_large.response().request_id(),
                                   refusal(base::RefusalCode::ResourceExhausted,
                                           "the answer is " + std::to_string(frame->size() - codec::header_bytes) +
                                               " bytes long, but the client accepts only " +
                                               std::to_string(frame_bytes_max_) + ": ask for less",
                                           base::Reason::AnswerTooLarge))),
            Kind::Answer);
}

void Session::answer(v1::Response response) {
    log_refusal(number_, by(), response);
    answer(encode_response(std::move(response)));
}

void Session::send_unasked(const v1::Response& response) {
    if (greeted_) {
        log_refusal(number_, by(), response);
    }
    enqueue(encode_response(response), Kind::Unasked);
}

void Session::event(const SharedBytes& frame) {
    // After an event was dropped, all further events are dropped until EventsDropped is sent. The client thus knows
    // where the gap is.
    if (dropped_events_ == 0 && event_bytes_ + frame->size() <= queued_event_bytes_max && takes(frame->size())) {
        return enqueue(frame, Kind::Event);
    }
    host_.limit_counters.met(Limit::QueuedEventBytes);
    count_dropped_events(1);
}

void Session::count_dropped_events(std::uint64_t count) {
    dropped_events_ += count;
    host_.traffic.events_dropped.add(count);
    wake_writer();
}

bool Session::may_send_snapshots() const {
    return begun_ && !finishing_ && !ended_ && !input_over_ && queue_.empty() && sending_.empty() &&
           dropped_events_ == 0;
}

void Session::send_snapshots() {
    if (!idle_ || !may_send_snapshots()) {
        return wake_writer();
    }
    // The snapshots are sent without waking the writer: with many viewers, waking the writers would double the cost.
    std::size_t sent = 0;
    for (; sent < snapshots_at_once && may_send_snapshots(); ++sent) {
        const streaming::OutgoingFrame* const frame = snapshots.next();
        if (frame == nullptr) {
            break;
        }
        send_frame(*frame);
    }
    snapshots.release();
    if (sent == snapshots_at_once || snapshots.retry_at() != runtime::Clock::time_point::max() ||
        !may_send_snapshots()) {
        wake_writer();
    }
}

void Session::send_frame(const streaming::OutgoingFrame& frame) {
    const auto& parts = frame.parts;
    const std::string_view tail = frame.tail_view();
    const std::size_t body_bytes = frame.body_bytes();
    const auto header =
        codec::encode_header({.channel = codec::Channel::Stream, .body_bytes = static_cast<std::uint32_t>(body_bytes)});
    const bool together = parts.size() > gathered_parts_max || body_bytes < gathered_bytes_min;
    std::array<asio::const_buffer, Transport::buffers_at_once> buffers;
    std::size_t buffer_count = 0;
    if (together) {
        host_.frame.assign(reinterpret_cast<const char*>(header.data()), header.size());
        for (const SharedBytes* part : parts) {
            host_.frame += **part;
        }
        host_.frame += tail;
        buffers[buffer_count++] = asio::buffer(host_.frame);
    } else {
        buffers[buffer_count++] = asio::buffer(header);
        for (const SharedBytes* part : parts) {
            buffers[buffer_count++] = asio::buffer(**part);
        }
        buffers[buffer_count++] = asio::buffer(tail);
    }
    const auto [error, count] = transport_.write_now(std::span{buffers}.first(buffer_count));
    if (error) {
        return close();
    }
    host_.traffic.sent_stream_bytes.add(count);
    if (count == header.size() + body_bytes) {
        return host_.traffic.snapshots_sent.add();
    }
    rest_.buffers.clear();
    if (together) {
        const auto rest = std::make_shared<const std::string>(host_.frame, count);
        sending_.push_back({{host_.send_memory, rest}, Kind::Snapshot});
        rest_.buffers.push_back(asio::buffer(*rest));
        return;
    }
    // The parts are not copied, because all sessions that receive them share them.
    rest_.header = header;
    rest_.tail = tail;
    rest_.buffers.push_back(asio::buffer(rest_.header));
    for (const SharedBytes* part : parts) {
        sending_.push_back({{host_.send_memory, *part}, Kind::Snapshot});
        rest_.buffers.push_back(asio::buffer(**part));
    }
    rest_.buffers.push_back(asio::buffer(rest_.tail));
    std::size_t gone = count;
    for (asio::const_buffer& buffer : rest_.buffers) {
        const std::size_t of_this = std::min(gone, buffer.size());
        buffer += of_this;
        gone -= of_this;
    }
}

void Session::enqueue(SharedBytes frame, Kind kind) {
    if (finishing_ || ended_) {
        return;
    }
    (kind == Kind::Event ? event_bytes_ : response_bytes_) += frame->size();
    queue_.push_back({{host_.send_memory, std::move(frame)}, kind});
    if (response_bytes_ > queued_response_bytes_max) {
        host_.limit_counters.met(Limit::QueuedResponseBytes);
        log::warn({.session = number_, .client = by()}, "session {}: {} closed: the client does not read its answers",
                  number_, by());
        close();
        return;
    }
    wake_writer();
}

void Session::written(const Queued& queued) {
    (queued.kind == Kind::Event ? event_bytes_ : response_bytes_) -= queued.bytes->size();
}

void Session::wake_writer() {
    if (std::exchange(idle_, false)) {
        writer_signal_.cancel();
    }
}

asio::awaitable<void> Session::wait_for_work(runtime::Clock::time_point until) {
    // wake_writer() cancels the timer. It runs on the same thread, so no wake-up can be lost before the wait begins.
    idle_ = true;
    writer_signal_.expires_at(until);
    co_await writer_signal_.async_wait(no_throw);
    idle_ = false;
}

asio::awaitable<void> Session::write() {
    std::vector<asio::const_buffer> buffers;
    std::size_t sent_at_once = 0;
    while (!ended_) {
        buffers.clear();
        if (!begun_) {
            co_await wait_for_work();
        } else if (!sending_.empty()) {
            const auto [error, count] = co_await transport_.write(rest_.buffers);
            host_.traffic.sent_stream_bytes.add(count);
            if (error) {
                break;
            }
            sending_.clear(); // the bytes are no longer counted
            rest_ = {};
            host_.traffic.snapshots_sent.add();
        } else if (!queue_.empty()) {
            // Answers and events are sent first, because they are small and clients wait for them.
            while (!queue_.empty() && sending_.size() < batch_frames_max) {
                // The request counts as answered before the write completes, because the client may send its next
                // request as soon as it has received the answer.
                in_flight_ -= queue_.front().kind == Kind::Answer;
                sending_.push_back(std::move(queue_.front()));
                queue_.pop_front();
                buffers.push_back(asio::buffer(*sending_.back().bytes));
            }
            const auto [error, count] = co_await transport_.write(buffers);
            host_.traffic.sent_control_bytes.add(count);
            if (error) {
                break;
            }
            for (const Queued& sent : sending_) {
                written(sent);
            }
            sending_.clear();
        } else if (input_over_ && !finishing_) {
            if (in_flight_ > 0) {
                co_await wait_for_work();
            } else if (turn_timer_.cancel() > 0) {
                co_await asio::post(transport_.socket().get_executor(), no_throw); // lets fail_when_answered() continue
            } else {
                finish();
            }
        } else if (dropped_events_ > 0 && !finishing_) {
            v1::Event event;
            event.mutable_events_dropped()->set_dropped_count(std::exchange(dropped_events_, 0));
            enqueue(encode_event(std::move(event)), Kind::Event);
        } else if (const auto* frame = finishing_ ? nullptr : snapshots.next()) {
            send_frame(*frame);
            // Let the thread serve other sessions.
            if (++sent_at_once == snapshots_at_once) {
                sent_at_once = 0;
                co_await asio::post(transport_.socket().get_executor(), no_throw);
            }
        } else if (finishing_) {
            break;
        } else {
            snapshots.release();
            co_await wait_for_work(snapshots.retry_at());
        }
    }
    if (finishing_ && !ended_) {
        co_await transport_.finish();
    } else {
        close();
    }
    sending_.clear();
    end();
}

// ---- closing ---------------------------------------------------------------------------------------------------

void Session::check_progress(runtime::Clock::duration watched) {
    const Transport::Progress progress = sending_.empty() ? Transport::Progress{} : transport_.progress();
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
        transport_.close();
    } else {
        transport_.abort();
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
