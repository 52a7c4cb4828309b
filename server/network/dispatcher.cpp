#include "server/network/dispatcher.h"

#include "server/access/role.h"
#include "server/base/assert.h"
#include "server/log/log.h"
#include "server/network/description.h"
#include "server/protocol/actors.h"
#include "server/protocol/commands.h"
#include "server/protocol/events.h"
#include "server/protocol/parameters.h"
#include "server/protocol/queries.h"
#include "server/protocol/refusals.h"
#include "server/protocol/request_rules.h"
#include "server/protocol/worlds.h"
#include "server/runtime/random_ids.h"
#include "server/simulation/world_name.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>

#include <algorithm>
#include <optional>
#include <utility>

namespace evod::network {
namespace {

base::Refusal no_such_subscription(const char* field, std::uint32_t subscription_id) {
    return {.code = base::RefusalCode::NotFound,
            .message = "this session has no such subscription",
            .violations = {{field, "one of this session's", std::to_string(subscription_id)}},
            .reason = base::Reason::SubscriptionNotFound};
}

/// Serialises a request deterministically: equal requests give equal bytes.
std::string bytes_of(const v1::Request& request) {
    std::string bytes;
    google::protobuf::io::StringOutputStream stream{&bytes};
    google::protobuf::io::CodedOutputStream coded{&stream};
    coded.SetSerializationDeterministic(true);
    request.SerializeToCodedStream(&coded);
    coded.Trim();
    return bytes;
}

v1::Response response_to(std::uint64_t request_id) {
    v1::Response response;
    response.set_request_id(request_id);
    return response;
}

replay::WantedMoment wanted(const v1::RunMoment& moment) {
    replay::WantedMoment to;
    if (moment.has_generation()) {
        to.generation = moment.generation();
    }
    if (moment.has_tick()) {
        to.tick = moment.tick();
    }
    return to;
}

/// Converts a request of the kind REQUEST_KIND_REPLAY into mail for the simulation thread.
runtime::ReplayMail replay_mail(const v1::Request& request, std::uint64_t session) {
    runtime::ReplayMail mail{.request = {},
                             .session = session,
                             .request_id = request.request_id(),
                             .request_name = protocol::name_of(request)};
    const std::string world = protocol::lookup_name(protocol::world_of(request));
    if (request.has_open_replay()) {
        const v1::OpenReplay& open = request.open_replay();
        mail.request =
            runtime::OpenReplay{.world = world, .at = open.has_at() ? std::optional{wanted(open.at())} : std::nullopt};
    } else if (request.has_seek()) {
        mail.request = runtime::Seek{.world = world, .to = wanted(request.seek().to())};
    } else {
        mail.request = runtime::CloseReplay{world};
    }
    return mail;
}

/// Converts a valid request into the table that an export writes.
replay::WantedTable wanted(const v1::ExportRun& request, access::Role role) {
    replay::WantedTable to;
    to.only_users = role < access::Role::Admin;
    to.table = static_cast<replay::RunTable>(request.table() - v1::RUN_TABLE_GENERATIONS);
    to.format =
        request.format() == v1::TEXT_FORMAT_JSON_LINES ? replay::Table::Format::JsonLines : replay::Table::Format::Csv;
    if (request.has_generation()) {
        to.generation = request.generation();
    }
    if (request.has_of()) {
        to.of = {request.of().generation(), request.of().island(), request.of().organism()};
    }
    to.first_generation = request.first_generation();
    return to;
}

/// Increments the counter of each limit that an invalid command exceeds.
void count_exceeded_limits(const v1::Request& request, LimitCounters& counters) {
    if (request.client_key().size() > protocol::client_key_bytes_max) {
        counters.met(Limit::ClientKeyBytes);
    }
    if (std::max(request.create_world().name().size(), request.fork_world().name().size()) >
        simulation::world_name_bytes_max) {
        counters.met(Limit::WorldNameBytes);
    }
}

/// Increments the counter of each limit that shortened an answer.
void count_shortened_answers(const protocol::QueryResult& result, LimitCounters& counters) {
    if (const auto* part = std::get_if<protocol::HistoryPart>(&result)) {
        if (part->begins_late) {
            counters.met(Limit::HistoryGenerationsKept);
        }
        if (part->next_generation) {
            counters.met(Limit::HistoryGenerations);
        }
    } else if (const auto* rows = std::get_if<protocol::PopulationRows>(&result)) {
        if (rows->first + rows->genes.size() < rows->organism_count) {
            counters.met(Limit::PopulationRows);
        }
    }
}

base::Refusal shutting_down_refusal() {
    return refusal(base::RefusalCode::Unavailable,
                   "the server is shutting down: send the request again after the restart",
                   base::Reason::ServerGoingAway);
}

} // namespace

Dispatcher::Dispatcher(asio::io_context& context, runtime::Mailbox& mailbox, runtime::Outbox& outbox,
                       const Sessions& sessions, Streams& streams, LimitCounters& limit_counters,
                       std::function<void()> shut_down, std::function<v1::Metrics()> metrics)
    : mailbox_{mailbox}
    , sessions_{sessions}
    , streams_{streams}
    , limit_counters_{limit_counters}
    , shut_down_{std::move(shut_down)}
    , metrics_{std::move(metrics)}
    , exports_{outbox, limit_counters}
    , breeding_queries_{outbox, limit_counters}
    , leases_{context,
              [this](const std::string& world, std::uint64_t lease) {
                  limit_counters_.met(Limit::Lease);
                  v1::Request request;
                  request.mutable_release_lease()->set_world(world);
                  handle_own(std::move(request), lease);
              }}
    , reply_cache_{{.kept_per_key = retries_kept,
                    .keys_max = client_keys_max,
                    .bytes_max = retry_bytes_max,
                    .evicted_max = evicted_keys_max},
                   [&limit_counters] { limit_counters.met(Limit::ClientKeys); }}
    , own_key_{"evod " + to_text(runtime::draw_run_id())} {}

base::Refusal Dispatcher::busy() {
    limit_counters_.met(Limit::MailboxCommands);
    return refusal(base::RefusalCode::ResourceExhausted, "the server is busy, its mailbox is full: try again",
                   base::Reason::ServerBusy);
}

void Dispatcher::handle(Session& session, v1::Request request) {
    const auto refuse_it = [&](const base::Refusal& refused) {
        session.send_unasked(protocol::refusing(request.request_id(), refused));
    };
    if (going_away_) {
        return refuse_it(shutting_down_refusal());
    }
    const v1::RequestRules* rules = protocol::rules_of(request);
    if (rules == nullptr) {
        return refuse_it(refusal(
            base::RefusalCode::Unimplemented,
            "this server does not know the request: it may be older than the client; Describe lists what it knows",
            base::Reason::RequestUnknown));
    }
    if (log::wanted(log::Level::Trace)) {
        log::trace({.session = session.number(), .client = session.by()}, "session {}: {} sends {}, request {}",
                   session.number(), session.by(), protocol::name_of(request), request.request_id());
    }
    const bool in_own_replay = session.replays.contains(protocol::world_of(request));
    if (const auto needed = access::role_needed(*rules, in_own_replay); session.visitor().role < needed) {
        return refuse_it(refusal(base::RefusalCode::PermissionDenied,
                                 protocol::name_of(request) + " needs the role " + access::name_of(needed) +
                                     "; this session has the role " + access::name_of(session.visitor().role) +
                                     ": connect with a token of that role"));
    }
    if (request.request_id() == 0) {
        return refuse_it(protocol::invalid({{"request_id", "at least 1", "0"}}));
    }
    if (!session.admit_request()) {
        return refuse_it(refusal(base::RefusalCode::ResourceExhausted,
                                 std::to_string(requests_in_flight_max) +
                                     " requests of this session are unanswered: wait for an answer",
                                 base::Reason::RequestsInFlightMax));
    }
    if (session.query_under_way) {
        return session.hold_back(std::move(request));
    }
    serve(session, std::move(request));
}

void Dispatcher::serve_held_back(Session& session) {
    while (!session.query_under_way) {
        if (auto request = session.take_held_back()) {
            serve(session, *std::move(request));
        } else {
            return;
        }
    }
}

void Dispatcher::serve(Session& session, v1::Request request) {
    if (going_away_) {
        return session.answer(protocol::refusing(request.request_id(), shutting_down_refusal()));
    }
    switch (protocol::kind_of(request)) {
    case v1::REQUEST_KIND_COMMAND:
        return command(session, request);
    case v1::REQUEST_KIND_QUERY:
        return query(session, std::move(request));
    case v1::REQUEST_KIND_SUBSCRIPTION:
        return subscription(session, std::move(request));
    case v1::REQUEST_KIND_REPLAY:
        return replay(session, request);
    case v1::REQUEST_KIND_EXPORT:
        return export_text(session, std::move(request));
    case v1::REQUEST_KIND_LEASE:
        return ask(session, std::move(request));
    case v1::REQUEST_KIND_SERVER:
        log::info({.session = session.number(), .client = session.by()}, "session {}: {} shuts the server down",
                  session.number(), session.by());
        session.answer(response_to(request.request_id()));
        return shut_down_();
    default:
        return; // handle() has already refused this request
    }
}

void Dispatcher::restore(const std::vector<run_file::JournalEntry>& answers) {
    for (const run_file::JournalEntry& entry : answers) {
        reply_cache_.restore(ReplyCache::key_of(run_file::user_of(entry.origin), entry.origin.client_key),
                             entry.origin.request_id, entry.origin.request,
                             std::make_shared<const std::string>(entry.answer));
    }
}

void Dispatcher::command(Session& session, const v1::Request& request) {
    const std::uint64_t id = request.request_id();
    const auto refused = [id](const base::Refusal& why) { return protocol::refusing(id, why); };

    if (const auto unknown = protocol::unknown_field_of(request)) {
        return session.answer(refused(
            {.code = base::RefusalCode::Unimplemented,
             .message = "this server does not know a field of the command: it may be older than the client",
             .violations = {{*unknown, "fields of this server's version; Describe lists them", "an unknown field"}},
             .reason = base::Reason::FieldUnknown}));
    }
    auto command = protocol::to_command(request, {runtime::draw_seed(), runtime::draw_run_id()});
    if (!command) {
        count_exceeded_limits(request, limit_counters_);
        return session.answer(refused(command.error()));
    }

    const std::string key = ReplyCache::key_of(session.visitor().name, request.client_key());
    std::string bytes = bytes_of(request);
    const auto verdict = reply_cache_.begin(key, id, bytes, [weak = session.weak_from_this()](const auto& frame) {
        if (const auto waiting = weak.lock()) {
            waiting->answer(frame);
        }
    });
    switch (verdict) {
    case ReplyCache::Verdict::Known:
        return;
    case ReplyCache::Verdict::Different:
        return session.answer(refused({.code = base::RefusalCode::InvalidArgument,
                                       .message = "this client_key has used the request_id for another request",
                                       .violations = {{"request_id", "an unused id", std::to_string(id)}},
                                       .reason = base::Reason::RequestIdReused}));
    case ReplyCache::Verdict::TooOld:
        limit_counters_.met(Limit::RetriesKept);
        return session.answer(refused(
            refusal(base::RefusalCode::FailedPrecondition,
                    "the request is older than the cached answers and may have been applied; it is not applied again: "
                    "read the current state, and send the command with a higher request_id",
                    base::Reason::RequestTooOld)));
    case ReplyCache::Verdict::New:
        break;
    }
    if (!send(*std::move(command), request, std::move(bytes), session.by(), session.number())) {
        reply_cache_.forget(key, id, encode_response(refused(busy())));
    }
}

void Dispatcher::handle_own(v1::Request request, std::optional<std::uint64_t> lease) {
    request.set_client_key(own_key_);
    request.set_request_id(++own_request_id_);
    auto command = protocol::to_command(request, {runtime::draw_seed(), runtime::draw_run_id()});
    EVOD_ASSERT(command.has_value());
    if (auto* release = std::get_if<simulation::ReleaseLease>(&*command)) {
        release->lease = lease;
    }
    send(*std::move(command), request, bytes_of(request), std::string{protocol::by_the_server}, 0);
}

bool Dispatcher::send(simulation::Command command, const v1::Request& request, std::string bytes, std::string by,
                      std::uint64_t session) {
    if (auto* change = std::get_if<simulation::SetParameters>(&command)) {
        change->by = by;
    }
    return mailbox_.try_push(runtime::CommandMail{.command = std::move(command),
                                                  .origin = {.client = std::move(by),
                                                             .client_key = request.client_key(),
                                                             .request_id = request.request_id(),
                                                             .request = std::move(bytes)},
                                                  .request_name = protocol::name_of(request),
                                                  .session = session});
}

void Dispatcher::deliver(std::vector<runtime::Delivery> deliveries) {
    for (runtime::Delivery& delivery : deliveries) {
        if (auto* reply = std::get_if<runtime::Reply>(&delivery)) {
            std::visit([this](auto& done) { on_done(std::move(done)); }, *reply);
        } else {
            // Destroys the call and its captured data before the next delivery.
            std::exchange(std::get<runtime::Call>(delivery), nullptr)();
        }
    }
}

void Dispatcher::on_done(runtime::CommandDone done) {
    const runtime::CommandMail& mail = done.mail;
    const std::string key = ReplyCache::key_of(run_file::user_of(mail.origin), mail.origin.client_key);
    const auto frame = std::make_shared<const std::string>(std::move(done.frame));
    if (!done.outcome) {
        return on_refused(mail, done.outcome.error(), key, frame);
    }
    reply_cache_.finish(key, mail.origin.request_id, frame);
    const std::string& world = done.outcome->world;
    if (std::holds_alternative<simulation::DeleteWorld>(mail.command)) {
        streams_.forget_world(world);
    }
    if (done.event) {
        streams_.publish(*std::move(done.event));
    }
    if (!done.lease) {
        leases_.end(world);
    } else if (std::holds_alternative<simulation::RunUntilTick>(mail.command) && !going_away_) {
        leases_.begin(world, *done.lease, key);
    }
}

void Dispatcher::on_damaged(const v1::Event& event) {
    leases_.end(event.world());
    streams_.forget_world(event.world());
    streams_.publish(event);
}

void Dispatcher::on_refused(const runtime::CommandMail& mail, const base::Refusal& why, const std::string& key,
                            const SharedBytes& frame) {
    if (mail.session == 0) {
        if (why.reason != base::Reason::NoLease) {
            log::error("the server's own command {} is refused: {}", mail.request_name, to_text(why));
        }
        return;
    }
    log_refusal(mail.session, mail.origin.client, mail.origin.request_id, why);
    if (why.reason == base::Reason::PlannedChangesMax) {
        limit_counters_.met(Limit::PlannedChanges);
    } else if (why.reason == base::Reason::PlacedMax) {
        limit_counters_.met(Limit::Placed);
    } else if (why.reason == base::Reason::WorldsMax) {
        limit_counters_.met(Limit::Worlds);
    }
    // A temporary refusal is not cached, so the same request may succeed when the client sends it again.
    if (why.code == base::RefusalCode::Unavailable || why.code == base::RefusalCode::ResourceExhausted) {
        reply_cache_.forget(key, mail.origin.request_id, frame);
    } else {
        reply_cache_.finish(key, mail.origin.request_id, frame);
    }
}

SessionPtr Dispatcher::find(std::uint64_t session) const {
    const auto found = sessions_.find(session);
    return found == sessions_.end() ? nullptr : found->second;
}

bool Dispatcher::ask(Session& session, std::uint64_t request_id, runtime::Mail mail) {
    if (mailbox_.try_push(std::move(mail))) {
        return true;
    }
    session.answer(protocol::refusing(request_id, busy()));
    return false;
}

void Dispatcher::ask(Session& session, v1::Request request) {
    const auto asked = std::make_shared<const v1::Request>(std::move(request));
    const bool users_only = session.visitor().role < access::Role::Controller;
    if (ask(session, asked->request_id(), runtime::QueryMail{session.number(), asked, users_only})) {
        session.query_under_way = true;
        session.expect(static_cast<std::ptrdiff_t>(protocol::row_bytes_max(*asked)));
    }
}

void Dispatcher::on_done(runtime::QueryDone done) {
    const SessionPtr session = find(done.mail.session);
    if (!session) {
        return;
    }
    const v1::Request& request = *done.mail.request;
    session->query_under_way = false;
    session->expect(-static_cast<std::ptrdiff_t>(protocol::row_bytes_max(request)));
    count_shortened_answers(done.result, limit_counters_);
    protocol::add_rows(done.result, done.response);
    if (const auto* world = std::get_if<protocol::FoundWorld>(&done.result)) {
        if (const auto refused = apply(request, *world, *session, done.response)) {
            *done.response.mutable_status() = protocol::to_proto(*refused);
        }
    }
    session->answer(std::move(done.response));
    serve_held_back(*session);
}

void Dispatcher::query(Session& session, v1::Request request) {
    const std::uint64_t id = request.request_id();
    if (auto faults = protocol::faults_of(request); !faults.empty()) {
        return session.answer(protocol::refusing(id, protocol::invalid(std::move(faults))));
    }
    switch (request.kind_case()) {
    case v1::Request::kGetBreeding:
        return find_run(session, std::move(request));
    case v1::Request::kGetMetrics: {
        v1::Response response = response_to(id);
        *response.mutable_metrics() = metrics_();
        return session.answer(std::move(response));
    }
    case v1::Request::kDescribe: {
        v1::Response response = response_to(id);
        *response.mutable_description() = description();
        *response.mutable_description()->mutable_limits() = session.limits();
        return session.answer(std::move(response));
    }
    default:
        break;
    }
    // For a long answer the simulation thread only copies the rows. on_done() converts them into a message.
    ask(session, std::move(request));
}

void Dispatcher::set_view(Session& session, const v1::Request& request) {
    const std::uint64_t id = request.request_id();
    const std::uint32_t subscription_id = request.set_view().subscription_id();
    const auto found = session.snapshots.subscriptions.find(subscription_id);
    if (found == session.snapshots.subscriptions.end()) {
        return session.answer(
            protocol::refusing(id, no_such_subscription("set_view.subscription_id", subscription_id)));
    }
    if (!found->second.view) {
        return session.answer(protocol::refusing(
            id, refusal(base::RefusalCode::FailedPrecondition,
                        "the subscription has no view: its snapshots are not made of tiles", base::Reason::NoView)));
    }
    v1::Response response = response_to(id);
    response.mutable_subscription()->set_subscription_id(subscription_id);
    response.mutable_subscription()->set_rate_hz(found->second.rate_hz);
    session.answer(encode_response(std::move(response))); // the answer must precede the first snapshot of the new view
    return streams_.set_view(session, subscription_id, request.set_view().view());
}

void Dispatcher::subscription(Session& session, v1::Request request) {
    const std::uint64_t id = request.request_id();
    const auto refuse_it = [&](const base::Refusal& refused) { session.answer(protocol::refusing(id, refused)); };
    if (request.has_unsubscribe()) {
        const std::uint32_t subscription_id = request.unsubscribe().subscription_id();
        if (!streams_.unsubscribe(session, subscription_id)) {
            return refuse_it(no_such_subscription("unsubscribe.subscription_id", subscription_id));
        }
        return session.answer(response_to(id));
    }
    if (request.has_request_keyframe()) {
        const std::uint32_t subscription_id = request.request_keyframe().subscription_id();
        if (!streams_.send_keyframes(session, subscription_id)) {
            return refuse_it(no_such_subscription("request_keyframe.subscription_id", subscription_id));
        }
        return session.answer(response_to(id));
    }
    if (auto faults = protocol::faults_of(request); !faults.empty()) {
        return refuse_it(protocol::invalid(std::move(faults)));
    }
    if (request.has_set_view()) {
        return set_view(session, request);
    }

    // The simulation thread finds the world. The subscription then begins in apply(), on the network thread.
    ask(session, std::move(request));
}

std::optional<base::Refusal> Dispatcher::apply(const v1::Request& request, const protocol::FoundWorld& world,
                                               Session& session, v1::Response& response) {
    if (request.has_renew_lease()) {
        const std::string& key = request.client_key();
        if (leases_.renew(world.name, ReplyCache::key_of(session.visitor().name, key))) {
            return std::nullopt;
        }
        return base::Refusal{.code = base::RefusalCode::FailedPrecondition,
                             .message = "this client_key has no lease of that world: it gets one with "
                                        "run_until_tick on a running world",
                             .violations = {{"client_key", "the key of the run_until_tick", key}},
                             .reason = base::Reason::NoLease};
    }
    if (session.snapshots.subscriptions.size() + session.events.size() >= subscriptions_max) {
        limit_counters_.met(Limit::Subscriptions);
        return refusal(base::RefusalCode::ResourceExhausted,
                       "this session already has " + std::to_string(subscriptions_max) +
                           " subscriptions: unsubscribe from one first",
                       base::Reason::SubscriptionsMax);
    }
    if (request.has_subscribe_snapshots()) {
        return subscribe(request.subscribe_snapshots(), world, session, response);
    }
    EventSubscription subscription;
    if (request.subscribe_events().has_world()) {
        subscription.world = world.name;
    }
    response.mutable_subscription()->set_subscription_id(streams_.subscribe(session, std::move(subscription)));
    return std::nullopt;
}

std::optional<base::Refusal> Dispatcher::subscribe(const v1::SubscribeSnapshots& request,
                                                   const protocol::FoundWorld& world, Session& session,
                                                   v1::Response& response) {
    const double rate_hz = std::clamp(request.rate_hz(), snapshot_rate_hz_min, snapshot_rate_hz_max);
    if (rate_hz < request.rate_hz()) {
        limit_counters_.met(Limit::SnapshotRate);
    }
    auto subscription = streaming::to_subscription(request, world.name, world.island_count, rate_hz);
    std::size_t watched = subscription.island_count;
    for (const auto& [number, other] : session.snapshots.subscriptions) {
        watched += other.island_count;
    }
    if (watched > watched_islands_max) {
        limit_counters_.met(Limit::WatchedIslands);
        return refusal(base::RefusalCode::ResourceExhausted,
                       "the subscriptions of this session would come to more than " +
                           std::to_string(watched_islands_max) +
                           " islands: subscribe to single islands, or unsubscribe first",
                       base::Reason::SubscriptionsMax);
    }
    response.mutable_subscription()->set_rate_hz(rate_hz);
    response.mutable_subscription()->set_subscription_id(streams_.subscribe(session, std::move(subscription)));
    return std::nullopt;
}

void Dispatcher::replay(Session& session, const v1::Request& request) {
    const std::uint64_t id = request.request_id();
    if (auto faults = protocol::faults_of(request); !faults.empty()) {
        return session.answer(protocol::refusing(id, protocol::invalid(std::move(faults))));
    }
    ask(session, id, replay_mail(request, session.number()));
}

void Dispatcher::on_done(runtime::ReplayDone done) {
    const runtime::ReplayMail& mail = done.mail;
    const bool opens = std::holds_alternative<runtime::OpenReplay>(mail.request);
    if (opens && !done.world && done.world.error().code == base::RefusalCode::ResourceExhausted) {
        limit_counters_.met(Limit::Replays);
    }
    const SessionPtr session = find(mail.session);
    if (!session) {
        return;
    }
    if (!done.world) {
        return session->answer(
            protocol::refusing(mail.request_id, protocol::with_paths(done.world.error(), mail.request_name)));
    }
    if (opens) {
        session->replays.insert(*done.world);
    } else if (std::holds_alternative<runtime::CloseReplay>(mail.request)) {
        session->replays.erase(*done.world);
    }
    v1::Response response = response_to(mail.request_id);
    if (done.shown) {
        *response.mutable_world() = *std::move(done.shown);
    }
    session->answer(std::move(response));
}

void Dispatcher::export_text(Session& session, v1::Request request) {
    const std::uint64_t id = request.request_id();
    if (auto faults = protocol::faults_of(request); !faults.empty()) {
        return session.answer(protocol::refusing(id, protocol::invalid(std::move(faults))));
    }
    if (request.has_continue_export()) {
        return exports_.send_next_part(session, id, request.continue_export());
    }
    find_run(session, std::move(request));
}

void Dispatcher::find_run(Session& session, v1::Request request) {
    const auto asked = std::make_shared<const v1::Request>(std::move(request));
    ask(session, asked->request_id(), runtime::FindRun{session.number(), asked});
}

void Dispatcher::on_done(runtime::RunFound done) {
    const SessionPtr session = find(done.mail.session);
    if (!session) {
        return;
    }
    const v1::Request& request = *done.mail.request;
    const std::uint64_t id = request.request_id();
    if (!done.run) {
        session->answer(protocol::refusing(id, protocol::with_paths(done.run.error(), protocol::name_of(request))));
    } else if (request.has_export_run()) {
        exports_.begin(*session, id, done.run->run, wanted(request.export_run(), session->visitor().role));
    } else {
        breeding_queries_.ask(*session, id, request.get_breeding(), *std::move(done.run));
    }
}

void Dispatcher::forget(const Session& session) {
    exports_.forget(session);
    breeding_queries_.forget(session);
    mailbox_.push(runtime::SessionEnded{session.number()});
}

} // namespace evod::network
