#include "server/network/session.h"

#include "server/log/log.h"
#include "server/network/detached.h"
#include "server/network/no_throw.h"
#include "server/protocol/commands.h"
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

constexpr std::size_t name_bytes_max = 64;
constexpr std::uint32_t client_frame_bytes_min = 65'536; // every client takes at least this
constexpr std::size_t batch_frames_max = 64;
constexpr std::size_t snapshots_at_once = 32; // of one session, before other sessions are served
// A frame of many parts, or of a few short ones, is copied together before it is passed to the kernel.
constexpr std::size_t gathered_parts_max = 12, gathered_bytes_min = 32 << 10;
static_assert(gathered_parts_max + 2 <= Line::buffers_at_once, "there are a header and a tail, too");

tcp::endpoint peer_of(const tcp::socket& socket) {
    boost::system::error_code ignored; // one who has gone already is at no address
    return socket.remote_endpoint(ignored);
}

std::string to_text(const tcp::endpoint& endpoint) {
    return endpoint.address().to_string() + ":" + std::to_string(endpoint.port());
}

/// As far as an address tells people apart: of IPv6, whoever has one has a whole /64.
std::string neighbourhood_of(const asio::ip::address& address) {
    if (!address.is_v6()) {
        return address.to_string();
    }
    auto bytes = address.to_v6().to_bytes();
    if (address.to_v6().is_v4_mapped()) {
        return asio::ip::make_address_v4(asio::ip::v4_mapped, address.to_v6()).to_string();
    }
    std::fill(bytes.begin() + 8, bytes.end(), static_cast<unsigned char>(0));
    return asio::ip::address_v6{bytes}.to_string();
}

v1::Role to_proto(access::Role role) {
    switch (role) {
    case access::Role::Viewer:
        return v1::ROLE_VIEWER;
    case access::Role::Controller:
        return v1::ROLE_CONTROLLER;
    case access::Role::Admin:
        return v1::ROLE_ADMIN;
    }
    return v1::ROLE_UNSPECIFIED;
}

} // namespace

void log_refusal(std::uint64_t session, const std::string& by, const v1::Response& response) {
    if (response.status().code() == v1::CODE_UNSPECIFIED) {
        return;
    }
    const char* code = name_of(static_cast<base::RefusalCode>(response.status().code()));
    log::debug({.session = session, .client = by, .code = code}, "session {}: {} is refused request {}: {}: {}",
               session, by, response.request_id(), code, response.status().message());
}

SharedBytes encode_control(const v1::ServerMessage& message) {
    return std::make_shared<const std::string>(codec::encode_frame(codec::Channel::Control, message));
}

SharedBytes encode_response(v1::Response response) {
    v1::ServerMessage message;
    *message.mutable_response() = std::move(response);
    return encode_control(message);
}

SharedBytes encode_goodbye(const base::Refusal& why) {
    v1::ServerMessage message;
    *message.mutable_goodbye()->mutable_status() = protocol::to_proto(why);
    return encode_control(message);
}

SharedBytes encode_event(v1::Event event) {
    using namespace std::chrono;
    event.set_time_ms(duration_cast<milliseconds>(system_clock::now().time_since_epoch()).count());
    v1::ServerMessage message;
    *message.mutable_event() = std::move(event);
    return encode_control(message);
}

Session::Session(tcp::socket socket, SessionHost& host, std::uint64_t number)
    : snapshots{*host.clock, host.traffic.pictures_dropped, *this}
    , line_{std::move(socket), host.tls}
    , host_{host}
    , number_{number}
    , peer_{peer_of(line_.socket())}
    , neighbourhood_{neighbourhood_of(peer_.address())}
    , reader_bytes_{host.buffers}
    , expected_bytes_{host.buffers}
    , held_back_bytes_{host.buffers}
    , turns_to_send_{requests_per_s_max, request_burst_max, host.clock->now()}
    , hello_timer_{line_.socket().get_executor()}
    , frame_timer_{line_.socket().get_executor()}
    , turn_timer_{line_.socket().get_executor()}
    , farewell_timer_{line_.socket().get_executor()}
    , writer_signal_{line_.socket().get_executor(), asio::steady_timer::time_point::max()} {
    boost::system::error_code ignored; // a socket without these options works, only less well
    line_.socket().set_option(tcp::no_delay{true}, ignored);
    line_.socket().set_option(asio::socket_base::keep_alive{true}, ignored);
    const auto set = [&](int option, std::int64_t value) {
        const int given = static_cast<int>(value);
        ::setsockopt(line_.socket().native_handle(), IPPROTO_TCP, option, &given, sizeof given);
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
        line_.socket().get_executor(), [self = shared_from_this()] { return self->read(); }, detached);
    asio::co_spawn(
        line_.socket().get_executor(), [self = shared_from_this()] { return self->write(); }, detached);
    if (refused) {
        fail(*refused);
        return;
    }
    hello_timer_.expires_after(hello_timeout);
    hello_timer_.async_wait([weak = weak_from_this()](boost::system::error_code error) {
        if (const auto self = weak.lock(); self && !error && !self->greeted_) {
            self->host_.limit_counters.met(Limit::HelloTimeout);
            self->fail(refusal(base::RefusalCode::FailedPrecondition,
                               "no hello came within " + std::to_string(hello_timeout.count()) +
                                   " s: connect again, and send one first",
                               base::Reason::HelloMissing));
            if (!self->begun_) {
                self->close(); // TLS has not begun: it cannot be told
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
    if (const auto error = co_await line_.begin(); error == Line::not_tls()) {
        fail(refusal(base::RefusalCode::FailedPrecondition,
                     "this server speaks TLS only: evoctl and evoview take --ca FILE or --tls",
                     base::Reason::TlsRequired));
    } else if (error) {
        if (!ended_) { // otherwise whoever ended it has said why
            log_closed({}, "TLS: " + error.message());
        }
        close();
    }
    begun_ = true;
    wake_writer();
    while (!finishing_ && !ended_) {
        const auto [error, count] = co_await line_.read_some(asio::buffer(bytes));
        const bool more_to_say = in_flight_ + queue_.size() + sending_.size() > 0;
        if (error == asio::error::eof && more_to_say && !finishing_ && !ended_) {
            // It has said all it wants, and may still read: it gets its answers.
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
                if (frame.error().beyond == codec::Beyond::FrameBytes) {
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
            // Other sessions have their turn before the next frame.
            co_await asio::post(line_.socket().get_executor(), no_throw);
        }
        mind_frame(one_came);
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

void Session::mind_frame(bool one_came) {
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
                               "a frame did not come whole within " + std::to_string(frame_timeout.count()) +
                                   " s: connect again, and send each in one go",
                               base::Reason::FrameLate));
        }
    });
}

asio::awaitable<void> Session::wait_for_turn(double cost) {
    host_.limit_counters.met(Limit::RequestsPerSecond);
    host_.limit_counters.met(Limit::RequestBurst);
    // What does not come now is not late: it is not being read.
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

/// What the client still sends is read away, for closing with bytes unread would take the last answer from it.
asio::awaitable<void> Session::discard_input() {
    std::array<std::byte, 16384> bytes;
    for (;;) {
        const auto [error, count] = co_await line_.read_some(asio::buffer(bytes));
        if (error) {
            break;
        }
    }
    close();
}

void Session::on_frame(const codec::Frame& frame) {
    auto message = codec::parse_body<v1::ClientMessage>(frame.body);
    if (!message && message.error().beyond == codec::Beyond::MessageDepth) {
        host_.limit_counters.met(Limit::MessageDepth);
    }
    if (!greeted_) {
        if (!message) {
            return fail(
                refusal(base::RefusalCode::InvalidArgument, message.error().what, base::Reason::MessageUnreadable));
        }
        if (!message->has_hello()) {
            return fail(refusal(base::RefusalCode::FailedPrecondition, "the first message must be a hello",
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
                                                   "this session has had its hello already: send requests",
                                                   base::Reason::HelloRepeated)));
        break;
    case v1::ClientMessage::KIND_NOT_SET:
        send_unasked(protocol::refusing(0, refusal(base::RefusalCode::Unimplemented,
                                                   "this server does not know the message: it may be older than "
                                                   "the client; Describe tells what it knows",
                                                   base::Reason::RequestUnknown)));
        break;
    }
}

void Session::on_hello(const v1::Hello& hello) {
    std::vector<base::Violation> violations;
    const auto check_length = [&](const char* field, const std::string& text) {
        if (text.size() > name_bytes_max) {
            violations.push_back({field, "at most " + std::to_string(name_bytes_max) + " bytes",
                                  std::to_string(text.size()) + " bytes"});
        }
    };
    check_length("hello.client_name", hello.client_name());
    check_length("hello.client_version", hello.client_version());
    if (hello.frame_bytes_max() != 0 && hello.frame_bytes_max() < client_frame_bytes_min) {
        violations.push_back({"hello.frame_bytes_max", "0, or at least " + std::to_string(client_frame_bytes_min),
                              std::to_string(hello.frame_bytes_max())});
    }
    if (!violations.empty()) {
        return fail(protocol::invalid(std::move(violations)));
    }
    const std::uint32_t lowest = hello.protocol_version();
    const std::uint32_t highest = std::max(lowest, hello.protocol_version_max());
    if (codec::protocol_version < lowest || codec::protocol_version > highest) {
        return fail({.code = base::RefusalCode::FailedPrecondition,
                     .message = "this server speaks another version of the protocol: use a client of that version",
                     .violations = {{"hello.protocol_version", std::to_string(codec::protocol_version),
                                     highest == lowest ? std::to_string(lowest)
                                                       : std::to_string(lowest) + " to " + std::to_string(highest)}},
                     .reason = base::Reason::ProtocolVersion});
    }
    auto visitor = host_.admit(hello.token(), neighbourhood_);
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
    client_ = hello.client_name().empty() ? "unnamed" : protocol::quotable(hello.client_name());
    // In by(), a colon and a space end the user's name and nothing else.
    for (auto colon = client_.find(": "); colon != std::string::npos; colon = client_.find(": ")) {
        client_[colon] = ' ';
    }
    log_coming_or_going("connected as " + std::string{access::name_of(visitor_.role)} + ", version " +
                        (hello.client_version().empty() ? "unknown" : protocol::quotable(hello.client_version())));

    v1::ServerMessage message;
    v1::Welcome& welcome = *message.mutable_welcome();
    welcome.set_protocol_version(codec::protocol_version);
    welcome.set_server_version(EVOD_VERSION);
    welcome.set_instance_id(host_.instance_id);
    for (const char* feature :
         {"codec:plain", "codec:delta", "compression:zstd", "acknowledgements", "view", "planned_changes"}) {
        welcome.add_features(feature);
    }
    *welcome.mutable_limits() = limits();
    welcome.set_durability(host_.durability);
    if (host_.storage) {
        *welcome.mutable_storage() = *host_.storage;
    }
    welcome.set_role(to_proto(visitor_.role));
    welcome.set_user(visitor_.name);
    enqueue(encode_control(message), Kind::Unasked);
}

void Session::log_coming_or_going(const std::string& what) const {
    // On the server's own machine each call of evoctl opens and closes a session.
    const auto level = peer_.address().is_loopback() ? log::Level::Debug : log::Level::Info;
    if (log::wanted(level)) {
        log::write(level, {.session = number_, .client = by()},
                   "session " + std::to_string(number_) + ": " + by() + " " + what);
    }
}

void Session::log_closed(std::string_view code, const std::string& why) {
    const std::string who = greeted_ ? by() : to_text(peer_);
    std::string left_out;
    if (!greeted_) { // strangers must not fill the disk
        SessionHost::StrangersLog& strangers = host_.strangers_log;
        const auto now = host_.clock->now();
        if (!strangers.lines) {
            strangers.lines.emplace(stranger_lines_per_s, stranger_lines_burst, now);
        }
        if (!strangers.lines->take(1, now)) {
            ++strangers.left_out;
            return;
        }
        if (strangers.left_out > 0) {
            left_out = "; " + std::to_string(std::exchange(strangers.left_out, 0)) + " others before it are not logged";
        }
    }
    log::info({.session = number_, .client = who, .code = std::string{code}}, "session {}: {} is closed: {}{}", number_,
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

// ---- what is sent ----------------------------------------------------------------------------------------------

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
    enqueue(encode_response(protocol::refusing(
                too_large.response().request_id(),
                refusal(base::RefusalCode::ResourceExhausted,
                        "the answer is " + std::to_string(frame->size() - codec::header_bytes) +
                            " bytes long, the client takes " + std::to_string(frame_bytes_max_) + ": ask for less",
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
    // Once some are dropped the rest are too until that has been told, so that the gap is where it is said to be.
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
    // Without waking the writer: with many viewers that would cost as much as all the rest.
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
    std::array<asio::const_buffer, Line::buffers_at_once> buffers;
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
    const auto [error, count] = line_.write_now(std::span{buffers}.first(buffer_count));
    if (error) {
        return close();
    }
    host_.traffic.sent_stream_bytes.add(count);
    if (count == header.size() + body_bytes) {
        return host_.traffic.pictures_sent.add();
    }
    rest_.buffers.clear();
    if (together) {
        const auto rest = std::make_shared<const std::string>(host_.frame, count);
        sending_.push_back({{host_.buffers, rest}, Kind::Snapshot});
        rest_.buffers.push_back(asio::buffer(*rest));
        return;
    }
    // The parts are not copied: all sessions that are sent them share them.
    rest_.header = header;
    rest_.tail = tail;
    rest_.buffers.push_back(asio::buffer(rest_.header));
    for (const SharedBytes* part : parts) {
        sending_.push_back({{host_.buffers, *part}, Kind::Snapshot});
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
    queue_.push_back({{host_.buffers, std::move(frame)}, kind});
    if (response_bytes_ > queued_response_bytes_max) {
        host_.limit_counters.met(Limit::QueuedResponseBytes);
        log::warn({.session = number_, .client = by()}, "session {}: {} is closed: it does not read its answers",
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
    // Woken by cancelling: whoever does runs on this thread too, so none comes between the look and the wait.
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
            const auto [error, count] = co_await line_.write(rest_.buffers);
            host_.traffic.sent_stream_bytes.add(count);
            if (error) {
                break;
            }
            sending_.clear(); // nobody counts any more what it held
            rest_ = {};
            host_.traffic.pictures_sent.add();
        } else if (!queue_.empty()) {
            // Answers and events first: they are small, and somebody waits for them.
            while (!queue_.empty() && sending_.size() < batch_frames_max) {
                // Whoever has the answer may ask again before the write is known to be over.
                in_flight_ -= queue_.front().kind == Kind::Answer;
                sending_.push_back(std::move(queue_.front()));
                queue_.pop_front();
                buffers.push_back(asio::buffer(*sending_.back().bytes));
            }
            const auto [error, count] = co_await line_.write(buffers);
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
                co_await asio::post(line_.socket().get_executor(), no_throw); // fail_when_answered() goes on
            } else {
                finish();
            }
        } else if (dropped_events_ > 0 && !finishing_) {
            v1::Event event;
            event.mutable_events_dropped()->set_dropped_count(std::exchange(dropped_events_, 0));
            enqueue(encode_event(std::move(event)), Kind::Event);
        } else if (const auto* frame = finishing_ ? nullptr : snapshots.next()) {
            send_frame(*frame);
            // Other sessions are served in between.
            if (++sent_at_once == snapshots_at_once) {
                sent_at_once = 0;
                co_await asio::post(line_.socket().get_executor(), no_throw);
            }
        } else if (finishing_) {
            break;
        } else {
            snapshots.release();
            co_await wait_for_work(snapshots.retry_at());
        }
    }
    if (finishing_ && !ended_) {
        co_await line_.finish();
    } else {
        close();
    }
    sending_.clear();
    end();
}

// ---- the end ---------------------------------------------------------------------------------------------------

void Session::mind_progress(runtime::Clock::duration watched) {
    const Line::Progress progress = sending_.empty() ? Line::Progress{} : line_.progress();
    if (sending_.empty() || ended_ || progress != progress_) {
        progress_ = progress;
        stalled_ = {};
    } else if (stalled_ += watched; stalled_ >= stalled_timeout) {
        host_.limit_counters.met(Limit::StalledTimeout);
        log::warn({.session = number_, .client = by()},
                  "session {}: {} is closed: for {} s it has taken nothing of what was sent to it", number_, by(),
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

void Session::make_room() {
    host_.limit_counters.met(Limit::ClientBufferBytes);
    log::warn({.session = number_, .client = by()},
              "session {}: {} is closed: more than {} MiB wait for all clients, of which {} KiB for it", number_, by(),
              client_buffer_bytes_max >> 20, held_bytes() >> 10);
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
        line_.close();
    } else {
        line_.abort();
    }
    hello_timer_.cancel();
    frame_timer_.cancel();
    turn_timer_.cancel();
    farewell_timer_.cancel();
    // What is being sent goes when the line has let go of it.
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
        log_coming_or_going("disconnected");
    }
    host_.ended(*this);
}

} // namespace evod::network
