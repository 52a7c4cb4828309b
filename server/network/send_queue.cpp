#include "server/network/send_queue.h"

#include <algorithm>

namespace evod::network {

namespace asio = boost::asio;

namespace {

constexpr std::size_t batch_frames_max = 64;

} // namespace

void SendQueue::push(SharedBytes frame, Kind kind) {
    std::size_t& counter = kind == Kind::Event ? event_bytes_ : response_bytes_;
    counter += frame->size();
    waiting_.push_back({{memory_, std::move(frame)}, &counter, kind == Kind::Answer});
}

bool SendQueue::has_room_for_event(std::size_t frame_bytes) const {
    return dropped_events_ == 0 && event_bytes_ + frame_bytes <= queued_event_bytes_max && accepts(frame_bytes);
}

std::size_t SendQueue::begin_batch() {
    std::size_t answer_count = 0;
    while (!waiting_.empty() && sending_.size() < batch_frames_max) {
        answer_count += waiting_.front().is_answer;
        sending_.push_back(std::move(waiting_.front()));
        waiting_.pop_front();
        buffers_.push_back(asio::buffer(*sending_.back().bytes));
    }
    return answer_count;
}

void SendQueue::begin_rest(const SharedBytes& rest) {
    sending_.push_back({{memory_, rest}, nullptr, false});
    buffers_.push_back(asio::buffer(*rest));
}

void SendQueue::begin_rest(const Header& header, std::span<const SharedBytes* const> parts, std::string_view tail,
                           std::size_t accepted_bytes) {
    header_and_tail_.assign(reinterpret_cast<const char*>(header.data()), header.size());
    header_and_tail_ += tail;
    buffers_.push_back(asio::buffer(header_and_tail_.data(), header.size()));
    for (const SharedBytes* part : parts) {
        parts_.push_back(*part);
        buffers_.push_back(asio::buffer(**part));
    }
    buffers_.push_back(asio::buffer(header_and_tail_) + header.size());
    for (asio::const_buffer& buffer : buffers_) {
        const std::size_t of_this = std::min(accepted_bytes, buffer.size());
        buffer += of_this;
        accepted_bytes -= of_this;
    }
}

void SendQueue::end_sending() {
    for (const Queued& sent : sending_) {
        if (sent.counter != nullptr) {
            *sent.counter -= sent.bytes->size();
        }
    }
    sending_.clear(); // the bytes are no longer counted
    parts_.clear();
    buffers_.clear();
}

std::size_t SendQueue::held_bytes() const {
    std::size_t bytes = 0;
    for (const Queued& queued : waiting_) {
        bytes += queued.bytes.share();
    }
    for (const Queued& queued : sending_) {
        bytes += queued.bytes.share();
    }
    for (const SharedBytes& part : parts_) {
        bytes += part->size() / static_cast<std::size_t>(part.use_count());
    }
    return bytes;
}

} // namespace evod::network
