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

constexpr std::size_t batch_frames_max = 64;
constexpr std::size_t snapshots_at_once = 32; // snapshots that one session sends before other sessions are served
// send_frame() copies a frame into one buffer if it has many parts or is short.
constexpr std::size_t gathered_parts_max = 12, gathered_bytes_min = 32 << 10;
static_assert(gathered_parts_max + 2 <= Transport::buffers_at_once, "there are a header and a tail, too");

} // namespace

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
    const auto [error, count] = transport_->write_now(std::span{buffers}.first(buffer_count));
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
            const auto [error, count] = co_await transport_->write(rest_.buffers);
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
            const auto [error, count] = co_await transport_->write(buffers);
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
                co_await asio::post(transport_->socket().get_executor(),
                                    no_throw); // lets fail_when_answered() continue
            } else {
                finish();
            }
        } else if (dropped_events_ > 0 && !finishing_) {
            v1::Event event;
            event.mutable_events_dropped()->set_dropped_count(std::exchange(dropped_events_, 0));
            enqueue(encode_event(std::move(event)), Kind::Event);
        } else if (transport_->control_waits() && !finishing_) {
            const auto [error, count] = co_await transport_->write(buffers);
            if (error) {
                break;
            }
        } else if (const auto* frame = finishing_ ? nullptr : snapshots.next()) {
            send_frame(*frame);
            // Let the thread serve other sessions.
            if (++sent_at_once == snapshots_at_once) {
                sent_at_once = 0;
                co_await asio::post(transport_->socket().get_executor(), no_throw);
            }
        } else if (finishing_) {
            break;
        } else {
            snapshots.release();
            co_await wait_for_work(snapshots.retry_at());
        }
    }
    if (finishing_ && !ended_) {
        co_await transport_->finish(
            close_code_.value_or(input_over_ ? WebSocketClose::Normal : WebSocketClose::GoingAway));
    } else {
        close();
    }
    sending_.clear();
    end();
}

} // namespace evod::network
