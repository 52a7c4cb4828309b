// Watching client: one end of a connection. It sends what a script says and checks what it receives.
//
// It cuts the sent bytes into frames as the server does, so it knows the requests. It checks that
// - the first message is a welcome, if the hello was valid;
// - every request gets exactly one response with its id;
// - requests for the simulation are answered in the order in which they were sent;
// - no request succeeds that the role does not allow;
// - every snapshot belongs to a subscription and can be decoded, deltas included;
// - events arrive only if subscribed to; and nothing follows the reason for the end of a session.
//
// While two outstanding requests have the same id, checks that need the request itself are skipped.
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
#include <tuple>
#include <utility>

namespace evod::fuzz {

/// Shared by all clients of a script: the first answers to commands.
struct Answers {
    using Command = std::tuple<std::string, std::string, std::uint64_t>; // user, client_key, request_id
    std::map<Command, std::string> first;
    std::map<Command, int> times_sent;
};

class WatchingClient {
  public:
    /// refused  the server refuses the connection, whatever the client sends.
    WatchingClient(int descriptor, Answers& answers, bool refused);
    ~WatchingClient();
    WatchingClient(const WatchingClient&) = delete;
    WatchingClient& operator=(const WatchingClient&) = delete;

    /// Appends bytes to those that wait to be sent.
    void say(const std::string& bytes) { unsent_ += bytes; }
    void say(const v1::ClientMessage& message) { say(codec::encode_frame(codec::Channel::Control, message)); }
    std::size_t unsent_bytes() const { return unsent_.size(); }
    /// Sends up to `count` waiting bytes, as far as the socket accepts them.
    void send(std::size_t count);
    /// Receives up to `count` bytes. Returns whether there were any.
    bool hear(std::size_t count);
    /// Closes the sending direction.
    void finish();

    bool closed() const { return closed_; } // by the server
    bool finished() const { return finished_; }
    /// Whether what it sent ends its session.
    bool refused() const { return refused_since_.has_value(); }
    /// It has not read for so long that the server may close its session without a Goodbye.
    bool may_have_stalled() const { return may_have_stalled_; }
    /// No response is outstanding.
    bool all_answered() const { return outstanding_.empty(); }
    /// It has received the reason for the end of its session, or that the server is going away.
    bool end_announced() const { return end_announced_; }

    std::uint64_t next_request_id() { return ++request_id_; }
    /// An acknowledgement of the last snapshot of a subscription, selected by `wanted`, if there is one.
    std::optional<v1::AcknowledgeSnapshot> newest_snapshot(std::size_t wanted) const;
    /// The id of a subscription, selected by `wanted`; 0 if there is none.
    std::uint32_t subscription(std::size_t wanted) const;

  private:
    struct Asked {
        v1::Request request;
        std::uint64_t place = 0; // in the order of sending
    };
    struct Island {
        codec::SnapshotDecoder decoder;
        std::uint64_t sequence = 0;             // of the last snapshot
        std::uint64_t acknowledged_up_to = 0;   // possibly before it was received
        std::set<std::uint64_t> unacknowledged; // sequences
    };
    struct Subscription {
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
    bool end_announced_ = false;
    bool ids_are_mixed_ = false, may_have_stalled_ = false;
    runtime::Clock::time_point all_heard_;                    // when it last had read everything
    std::optional<runtime::Clock::time_point> refused_since_; // since then the server ignores what it sends
    access::Role role_{};
    std::string user_;
    std::uint64_t request_id_ = 0, place_ = 0, last_place_answered_ = 0;
    std::multimap<std::uint64_t, Asked> outstanding_;     // by request id; 0: unreadable messages
    std::map<std::uint32_t, Subscription> subscriptions_; // to snapshots, by id
    std::set<std::uint32_t> event_subscriptions_;
};

} // namespace evod::fuzz
