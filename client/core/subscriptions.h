// Subscriptions: stores the subscriptions of a client. Requests every subscription in every session, decodes and
// acknowledges snapshots, and requests a keyframe after a damaged one.
//
// A subscription to a replay ends with its session: in later sessions its answer is the refusal NOT_FOUND.
//
// Threads      none of its own.
// Bounded      keeps the newest snapshot and the baseline for the next delta, for each subscription and island.
#pragma once

#include "client/core/request_queue.h"

#include "proto/codec/snapshot_decoder.h"

#include <map>
#include <memory>

namespace evod::core {

using Answers = std::map<SubscriptionHandle, evod::v1::Response>;
/// The newest snapshot of each island.
using IslandSnapshots = std::map<std::uint32_t, std::shared_ptr<const codec::ReceivedSnapshot>>;
using Snapshots = std::map<SubscriptionHandle, IslandSnapshots>;

class Subscriptions {
  public:
    explicit Subscriptions(RequestQueue& requests) : requests_{requests} {}
    Subscriptions(const Subscriptions&) = delete;

    void add(SubscriptionHandle handle, evod::v1::Request request);
    void set_view(SubscriptionHandle handle, evod::v1::View view);
    void remove(SubscriptionHandle handle);

    /// Requests all subscriptions for which no request is waiting. Called after the Welcome.
    void begin_session();
    void end_session();
    void take_answer(SubscriptionHandle handle, evod::v1::Response response);
    /// Takes the answer to SetView. If the server refuses the view, the subscription keeps the one before, and later
    /// sessions request that one.
    void take_view_answer(SubscriptionHandle handle, const evod::v1::Response& response);
    /// Decodes a snapshot. Counts damaged snapshots and the requests for keyframes in `status`. Returns the frame that
    /// acknowledges the snapshot; empty: none.
    std::string take_snapshot(evod::v1::SnapshotFrame frame, ConnectionStatus& status);

    /// Returns the server's last answer to each subscription in this session.
    const Answers& answers() const { return answers_; }
    /// Returns the snapshots that were decoded since the last call.
    Snapshots take_snapshots() { return std::exchange(snapshots_, {}); }

  private:
    /// The snapshot stream for one island, in this session.
    struct IslandStream {
        codec::SnapshotDecoder decoder;
        int keyframe_requests = 0; // number of keyframe requests since the last decoded snapshot
    };
    struct Subscription {
        evod::v1::Request request;                 // contains the last view that the server has accepted
        std::optional<evod::v1::View> wanted_view; // the newest view of set_view(), if it was not sent
        std::optional<evod::v1::View> sent_view;   // the view in the unanswered SetView
        bool ended = false;                        // it names a replay of an earlier session
        std::optional<std::uint32_t> server_id; // its id in this session; nullopt: the server has not accepted it yet
        std::map<std::uint32_t, IslandStream> islands;
    };
    static constexpr int keyframe_requests_max = 3;

    void request(SubscriptionHandle handle, bool first);
    void refuse_ended(SubscriptionHandle handle);
    /// Sends the wanted view, unless another one is unanswered.
    void send_view(SubscriptionHandle handle, Subscription& subscription);
    void unsubscribe_from(std::uint32_t server_id);

    RequestQueue& requests_;
    bool in_session_ = false;
    std::map<SubscriptionHandle, Subscription> subscriptions_;
    Answers answers_;
    Snapshots snapshots_;
};

} // namespace evod::core
