// Watching client: one end of a connection, that says whatever it is told to and checks whatever it hears.
//
// It cuts what it has said into frames as the server does, so it knows what has been asked. What must hold: the first
// message is a welcome, if the hello was right; every request has exactly one response with its id; those that went to
// the simulation are answered in the order in which they were sent; nothing is granted to whom it is not allowed; every
// picture belongs to a subscription, and can be decoded, a delta too; events come to who asked for them; and after the
// reason for its end a session says nothing more.
//
// Where request ids are used twice at a time, what needs the request itself is not checked.
#pragma once

#include "evod/v1/session.pb.h"
#include "proto/codec/framing.h"
#include "proto/codec/snapshot_decoder.h"
#include "server/access/role.h"
#include "server/runtime/clock.h"

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

namespace evod::fuzz {

/// What all clients of a script know together: the first answers to commands.
struct Answers {
    using Command = std::pair<std::string, std::uint64_t>; // client_key, request_id
    std::map<Command, std::string> first;
    std::map<Command, int> times_sent;
};

class WatchingClient {
  public:
    /// refused  it is told why it may not come in, whatever it says.
    WatchingClient(int descriptor, Answers& answers, bool refused);
    ~WatchingClient();
    WatchingClient(const WatchingClient&) = delete;
    WatchingClient& operator=(const WatchingClient&) = delete;

    /// Puts bytes behind those that wait to be sent.
    void say(const std::string& bytes) { unsent_ += bytes; }
    void say(const v1::ClientMessage& message) { say(codec::encode_frame(codec::Channel::Control, message)); }
    std::size_t unsent_bytes() const { return unsent_.size(); }
    /// The first `count` of those that wait, as far as they are taken.
    void send(std::size_t count);
    /// Up to `count` bytes. Whether there were any.
    bool hear(std::size_t count);
    /// It says nothing more, and still hears.
    void finish();

    bool closed() const { return closed_; } // by the server
    bool finished() const { return finished_; }
    /// Whether what it said ends its session.
    bool refused() const { return refused_since_.has_value(); }
    /// It has left things unread for so long that its session may be closed without a word.
    bool may_have_stalled() const { return may_have_stalled_; }
    /// Nothing is owed to it.
    bool all_answered() const { return outstanding_.empty(); }
    /// It has been told why its session ends, or that the server goes.
    bool told_of_end() const { return told_of_end_; }

    std::uint64_t next_request_id() { return ++request_id_; }
    /// The picture that was heard last for the subscription that is `wanted` among all, if there is one.
    std::optional<v1::AcknowledgeSnapshot> newest_picture(std::size_t wanted) const;
    /// The id of the subscription that is `wanted` among all; 0 if there is none.
    std::uint32_t subscription(std::size_t wanted) const;

  private:
    struct Asked {
        v1::Request request;
        std::uint64_t place = 0; // among all that were sent
    };
    struct Island {
        codec::SnapshotDecoder decoder;
        std::uint64_t sequence = 0;             // of the last
        std::uint64_t acknowledged_up_to = 0;   // perhaps before it was heard
        std::set<std::uint64_t> unacknowledged; // sequences
    };
    struct Watch {
        v1::SubscribeSnapshots asked;
        std::map<std::uint32_t, Island> islands;
    };

    void said(std::span<const std::byte> bytes);
    void said(const codec::Frame& frame);
    void owed(std::uint64_t request_id, Asked asked);
    void heard(const codec::Frame& frame);
    void heard(const v1::Response& response);
    void granted(const Asked& asked, const v1::Response& response);
    void heard(const v1::Event& event);
    void heard(v1::SnapshotFrame frame);

    const int descriptor_;
    Answers& answers_;
    std::string unsent_;
    codec::FrameReader said_{codec::hello_limits}, heard_{codec::client_limits};
    bool greeted_ = false, welcomed_ = false, finished_ = false, closed_ = false;
    bool told_of_end_ = false;
    bool ids_are_mixed_ = false, may_have_stalled_ = false;
    runtime::Clock::time_point all_heard_;                    // when it had last read everything
    std::optional<runtime::Clock::time_point> refused_since_; // what it says is not heard any more
    access::Role role_{};
    std::uint64_t request_id_ = 0, place_ = 0, last_place_answered_ = 0;
    std::multimap<std::uint64_t, Asked> outstanding_; // by request id; 0: what could not be read
    std::map<std::uint32_t, Watch> watches_;          // by subscription
    std::set<std::uint32_t> event_subscriptions_;
};

} // namespace evod::fuzz
