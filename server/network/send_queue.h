// Send queue: the answers and events that wait to be sent to a session's client, and the bytes that are being sent.
//
// Owner        the session, on the network thread. Its writer sends the bytes.
// Full         exceeds_limit() if more than queued_response_bytes_max of responses are unread; the session must then be
//              closed. If more than queued_event_bytes_max of events are unread, further events are dropped until their
//              number has been reported, so that the client knows where the gap is.
#pragma once

#include "proto/codec/framing.h"
#include "server/network/limits.h"
#include "server/network/send_memory.h"

#include <boost/asio/buffer.hpp>

#include <array>
#include <cstdint>
#include <deque>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace evod::network {

class SendQueue {
  public:
    enum class Kind { Answer, Unasked, Event };
    using Header = std::array<std::byte, codec::header_bytes>;

    explicit SendQueue(SendMemory& memory) : memory_{memory} {}
    SendQueue(const SendQueue&) = delete;

    /// The largest frame body that the client accepts.
    void set_frame_bytes_max(std::size_t bytes) { frame_bytes_max_ = bytes; }
    std::size_t frame_bytes_max() const { return frame_bytes_max_; }
    /// Whether the client accepts a frame of this size. The size includes the header.
    bool accepts(std::size_t frame_bytes) const { return frame_bytes - codec::header_bytes <= frame_bytes_max_; }

    void push(SharedBytes frame, Kind kind);
    /// Whether the client leaves too many bytes of responses unread.
    bool exceeds_limit() const { return response_bytes_ > queued_response_bytes_max; }
    /// Whether an event of this size may be pushed. Otherwise it must be counted as dropped.
    bool has_room_for_event(std::size_t frame_bytes) const;
    void count_dropped_events(std::uint64_t count) { dropped_events_ += count; }
    /// Returns the number of dropped events that were not reported yet.
    std::uint64_t take_dropped_events() { return std::exchange(dropped_events_, 0); }

    bool has_waiting_frames() const { return !waiting_.empty(); }
    bool is_sending() const { return !buffers_.empty(); }
    /// Whether everything has been sent and reported.
    bool is_idle() const { return waiting_.empty() && !is_sending() && dropped_events_ == 0; }

    /// Begins to send the first frames that wait. Returns the number of answers among them.
    std::size_t begin_batch();
    /// Begins to send the rest of a snapshot that the connection did not accept at once.
    void begin_rest(const SharedBytes& rest);
    /// The same for a snapshot that consists of these parts, of which the connection accepted the first bytes. The
    /// parts are not copied, because all sessions that receive them share them. SnapshotMemory counts them.
    void begin_rest(const Header& header, std::span<const SharedBytes* const> parts, std::string_view tail,
                    std::size_t accepted_bytes);
    /// What is being sent.
    const std::vector<boost::asio::const_buffer>& buffers() const { return buffers_; }
    /// Must be called when the write has ended.
    void end_sending();

    /// Drops the frames that wait. The bytes that are being sent are kept until the write has ended.
    void drop_waiting() { waiting_.clear(); }
    std::size_t held_bytes() const;

  private:
    struct Queued {
        SendMemory::Counted bytes;
        std::size_t* counter; // response_bytes_ or event_bytes_; nullptr: the rest of a snapshot
        bool is_answer;
    };

    SendMemory& memory_;
    std::size_t frame_bytes_max_ = std::numeric_limits<std::size_t>::max();
    std::deque<Queued> waiting_;
    std::vector<Queued> sending_;
    std::vector<SharedBytes> parts_; // of a snapshot that is being sent
    // Point to header_and_tail_ and the bytes in sending_ and parts_. Not empty: a write is in progress or about to
    // start.
    std::vector<boost::asio::const_buffer> buffers_;
    std::string header_and_tail_;
    std::size_t response_bytes_ = 0, event_bytes_ = 0; // bytes in waiting_ and sending_
    std::uint64_t dropped_events_ = 0;                 // number of dropped events that were not reported yet
};

} // namespace evod::network
