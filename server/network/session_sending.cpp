// The part of Session that sends: answers, events and snapshots.
#include "server/log/log.h"
#include "server/network/no_throw.h"
#include "server/network/session.h"
#include "server/protocol/refusals.h"

#include <boost/asio/buffer.hpp>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

namespace evod::network {
namespace {

constexpr std::size_t snapshots_at_once = 32; // snapshots that one session sends before other sessions are served
// send_frame() copies a frame into one buffer if it has many parts or is short.
constexpr std::size_t gathered_parts_max = 12, gathered_bytes_min = 32 << 10;
static_assert(gathered_parts_max + 2 <= Transport::buffers_at_once, "there are a header and a tail, too");

} // namespace

void Session::answer(SharedBytes frame) {
    rate_limit_.charge(static_cast<double>(frame->size() / answer_bytes_per_turn));
    if (queue_.accepts(frame->size())) {
        return enqueue(std::move(frame), Kind::Answer);
    }
    v1::ServerMessage too_large;
    too_large.ParseFromString(frame->substr(codec::header_bytes));
    enqueue(encode_response(
                protocol::refusing(too_large.response().request_id(),
                                   refusal(base::RefusalCode::ResourceExhausted,
                                           "the answer is " + std::to_string(frame->size() - codec::header_bytes) +
                                               " bytes long, but the client accepts only " +
                                               std::to_string(queue_.frame_bytes_max()) + ": ask for less",
                                           base::Reason::AnswerTooLarge))),
            Kind::Answer);
}

void Session::answer(v1::Response response) {
    log_refusal(number_, by(), response);
    answer(encode_response(std::move(response)));
}

void Session::send_unasked(const v1::Response& response) {
    if (greeted()) {
        log_refusal(number_, by(), response);
    }
    enqueue(encode_response(response), Kind::Unasked);
}

void Session::event(const SharedBytes& frame) {
    if (queue_.has_room_for_event(frame->size())) {
        return enqueue(frame, Kind::Event);
    }
    host_.limit_counters.met(Limit::QueuedEventBytes);
    count_dropped_events(1);
}

void Session::count_dropped_events(std::uint64_t count) {
    queue_.count_dropped_events(count);
    host_.traffic.events_dropped.add(count);
    writer_.notify();
}

bool Session::may_send_snapshots() const {
    return phase_ == Phase::Open && queue_.is_idle();
}

void Session::send_snapshots() {
    if (!writer_.is_awaited() || !may_send_snapshots()) {
        count_subscriptions();
        return writer_.notify();
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
    count_subscriptions();
    if (sent == snapshots_at_once || snapshots.retry_at() != runtime::Clock::time_point::max() ||
        !may_send_snapshots()) {
        writer_.notify();
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
    const auto [error, count] = transport_->write_now(std::span{buffers}.first(buffer_count));
    if (error) {
        return close();
    }
    host_.traffic.sent_stream_bytes.add(count);
    if (count == header.size() + body_bytes) {
        return host_.traffic.snapshots_sent.add();
    }
    if (together) {
        queue_.begin_rest(std::make_shared<const std::string>(host_.frame, count));
    } else {
        queue_.begin_rest(header, parts, tail, count);
    }
}

void Session::enqueue(SharedBytes frame, Kind kind) {
    if (is_over()) {
        return;
    }
    queue_.push(std::move(frame), kind);
    if (queue_.exceeds_limit()) {
        host_.limit_counters.met(Limit::QueuedResponseBytes);
        log_line(log::Level::Warn, {}, "closed: the client does not read its answers");
        close();
        return;
    }
    writer_.notify();
}

asio::awaitable<void> Session::write() {
    const std::vector<asio::const_buffer> control_only;
    std::size_t sent_at_once = 0;
    while (phase_ != Phase::Ended) {
        if (queue_.is_sending()) { // the rest of a snapshot
            const auto [error, count] = co_await transport_->write(queue_.buffers());
            host_.traffic.sent_stream_bytes.add(count);
            if (error) {
                break;
            }
            queue_.end_sending();
            host_.traffic.snapshots_sent.add();
        } else if (queue_.has_waiting_frames()) {
            // Answers and events are sent first, because they are small and clients wait for them. A request counts as
            // answered before the write completes, because the client may send its next request as soon as it has
            // received the answer.
            requests.count_answered(queue_.begin_batch());
            const auto [error, count] = co_await transport_->write(queue_.buffers());
            host_.traffic.sent_control_bytes.add(count);
            if (error) {
                break;
            }
            queue_.end_sending();
        } else if (phase_ == Phase::InputOver) {
            if (requests.unanswered() > 0) {
                co_await writer_.wait();
            } else if (turn_.is_awaited()) {
                turn_.notify();
                co_await asio::post(transport_->socket().get_executor(),
                                    no_throw); // lets fail_when_answered() continue
            } else {
                finish();
            }
        } else if (phase_ == Phase::Finishing) {
            break;
        } else if (const std::uint64_t dropped = queue_.take_dropped_events()) {
            v1::Event event;
            event.mutable_events_dropped()->set_dropped_count(dropped);
            enqueue(encode_event(std::move(event)), Kind::Event);
        } else if (transport_->control_waits()) {
            const auto [error, count] = co_await transport_->write(control_only);
            if (error) {
                break;
            }
        } else if (const auto* frame = snapshots.next()) {
            send_frame(*frame);
            // Let the thread serve other sessions.
            if (++sent_at_once == snapshots_at_once) {
                sent_at_once = 0;
                co_await asio::post(transport_->socket().get_executor(), no_throw);
            }
        } else {
            snapshots.release();
            count_subscriptions();
            co_await writer_.wait(snapshots.retry_at());
        }
    }
    if (phase_ == Phase::Finishing) {
        co_await transport_->finish(close_code_.value_or(WebSocketClose::GoingAway));
    } else {
        close();
    }
    queue_.end_sending();
    end_coroutine();
}

} // namespace evod::network
