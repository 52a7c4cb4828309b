#include "server/network/dispatcher.h"

#include "server/access/authorization.h"
#include "server/access/random.h"
#include "server/base/overloaded.h"
#include "server/log/log.h"
#include "server/network/description.h"
#include "server/network/subscription_requests.h"
#include "server/protocol/actors.h"
#include "server/protocol/commands.h"
#include "server/protocol/events.h"
#include "server/protocol/queries.h"
#include "server/protocol/refusals.h"
#include "server/protocol/request_rules.h"

#include <optional>
#include <utility>

namespace evod::network {
namespace {

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

/// Converts a request of the kind REQUEST_KIND_REPLAY into mail for the simulation threads.
runtime::ReplayMail replay_mail(const v1::Request& request, const Session& session) {
    runtime::ReplayMail mail{.request = {},
                             .session = session.number(),
                             .user = session.account(),
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
    to.only_users = role < access::Role::Controller;
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

/// Memory of a request that waits for its answer.
std::ptrdiff_t held_bytes(const v1::Request& request) {
    return static_cast<std::ptrdiff_t>(request.SpaceUsedLong());
}

/// Memory of the rows that a query has copied.
std::ptrdiff_t held_bytes(const protocol::QueryResult& result) {
    return static_cast<std::ptrdiff_t>(protocol::row_bytes(result));
}

base::Refusal shutting_down_refusal() {
    return refusal(base::RefusalCode::Unavailable,
                   "the server is shutting down: send the request again after the restart",
                   base::Reason::ServerGoingAway);
}

} // namespace

Dispatcher::Dispatcher(asio::io_context& context, runtime::Simulations& simulations, runtime::Outbox& outbox,
                       const Sessions& sessions, Streams& streams, SessionHost& host, std::size_t replays_max,
                       classes::Registry& classes, std::function<void()> shut_down,
                       std::function<v1::Metrics()> metrics)
    : simulations_{simulations}
    , sessions_{sessions}
    , streams_{streams}
    , host_{host}
    , shut_down_{std::move(shut_down)}
    , metrics_{std::move(metrics)}
    , background_queries_{outbox, simulations.job_turns(), sessions, host.limit_counters}
    , heartbeat_{simulations.mailbox_of("")}
    , commands_{context, simulations, streams, host.limit_counters}
    , class_requests_{context, classes, sessions, host, class_actions(), access::draw_random}
    , replay_places_{replays_max} {}

ClassActions Dispatcher::class_actions() {
    return {.create_world =
                [this](v1::Request request, simulation::Ownership ownership) {
                    return commands_.create_own(std::move(request), std::move(ownership));
                },
            .send = [this](v1::Request request) { commands_.handle_own(std::move(request)); },
            .set_class =
                [this](const std::string& name, std::optional<simulation::ClassRules> rules, base::Actor by,
                       std::function<void(const std::vector<std::string>&)> done) {
                    set_class(name, std::move(rules), std::move(by), std::move(done));
                }};
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
    const access::Requester requester{.user = session.user().name,
                                      .role = session.user().role,
                                      .in_own_replay = session.replays.contains(protocol::world_of(request))};
    // Whether the session's user owns the world is known to the simulation thread, which asks again.
    if (const auto permitted = access::may(requester, *rules, protocol::name_of(request), nullptr); !permitted) {
        return refuse_it(permitted.error());
    }
    if (request.request_id() == 0) {
        return refuse_it(protocol::invalid({{"request_id", "at least 1", "0"}}));
    }
    if (!session.requests.admit()) {
        host_.limit_counters.met(Limit::RequestsInFlight);
        return refuse_it(base::limit_refusal(std::to_string(requests_in_flight_max) +
                                                 " requests of this session are unanswered: wait for an answer",
                                             base::Reason::RequestsInFlightMax, "requests_in_flight_max",
                                             requests_in_flight_max, requests_in_flight_max));
    }
    if (session.requests.query_under_way) {
        return session.requests.hold_back(std::move(request));
    }
    serve(session, std::move(request));
}

void Dispatcher::serve(Session& session, v1::Request request) {
    if (going_away_) {
        return session.answer(protocol::refusing(request.request_id(), shutting_down_refusal()));
    }
    const std::uint64_t id = request.request_id();
    if (auto faults = protocol::faults_of(request); !faults.empty()) {
        return session.answer(protocol::refusing(id, protocol::invalid(std::move(faults))));
    }
    switch (protocol::kind_of(request)) {
    case v1::REQUEST_KIND_COMMAND:
        if (request.has_for_each_world()) {
            if (const auto refused = class_requests_.refusal_of(session, request.for_each_world())) {
                return session.answer(protocol::refusing(id, *refused));
            }
        }
        return commands_.handle(session, request);
    case v1::REQUEST_KIND_QUERY:
        return query(session, std::move(request));
    case v1::REQUEST_KIND_SUBSCRIPTION:
        if (change_subscription(session, request, streams_)) {
            return;
        }
        return ask(session, std::move(request)); // the simulation thread finds the world of the new subscription
    case v1::REQUEST_KIND_REPLAY:
        return serve_replay(session, request);
    case v1::REQUEST_KIND_EXPORT:
        if (request.has_continue_export()) {
            return background_queries_.send_next_part(session, id, request.continue_export());
        }
        return find_run(session, std::move(request));
    case v1::REQUEST_KIND_LEASE:
        return ask(session, std::move(request));
    case v1::REQUEST_KIND_CLASS:
        return class_requests_.handle(session, request);
    case v1::REQUEST_KIND_SERVER:
        log::info({.session = session.number(), .client = session.by()}, "session {}: {} shuts the server down",
                  session.number(), session.by());
        session.answer(response_to(id));
        return shut_down_();
    default:
        return; // handle() has already refused this request
    }
}

void Dispatcher::deliver(std::vector<runtime::Delivery> deliveries) {
    const base::Overloaded on_reply{
        [this](runtime::CommandDone& done) {
            done.fork ? background_queries_.check_fork(std::move(done)) : commands_.on_done(std::move(done));
        },
        [this](runtime::ExportPartDone& done) { background_queries_.on_done(std::move(done)); },
        [this](runtime::BreedingDone& done) { background_queries_.on_done(std::move(done)); },
        [this](runtime::BatchBegun& begun) { commands_.on_begun(std::move(begun)); },
        [this](runtime::Pong& /*pong*/) { heartbeat_.answered(); },
        [this](auto& done) { on_done(std::move(done)); }};
    expect_results(deliveries);
    for (runtime::Delivery& delivery : deliveries) {
        std::visit(base::Overloaded{[&](runtime::Reply& reply) {
                                        if (auto answer = simulations_.pass_on(std::move(reply))) {
                                            std::visit(on_reply, *answer);
                                        }
                                    },
                                    [this](v1::Event& event) { streams_.publish(std::move(event)); },
                                    [this](const runtime::StorageChanged& changed) { on_storage(changed); },
                                    [this](const simulation::DamagedWorld& damaged) { on_damaged(damaged); }},
                   delivery);
    }
}

void Dispatcher::expect_results(const std::vector<runtime::Delivery>& deliveries) {
    for (const runtime::Delivery& delivery : deliveries) {
        const auto* reply = std::get_if<runtime::Reply>(&delivery);
        if (const auto* done = reply != nullptr ? std::get_if<runtime::QueryDone>(reply) : nullptr) {
            if (const SessionPtr session = find_session(sessions_, done->mail.session)) {
                session->requests.expect(held_bytes(done->result));
            }
        }
    }
}

void Dispatcher::on_storage(const runtime::StorageChanged& changed) {
    v1::Event event = protocol::event_of(changed.storage, changed.world);
    if (changed.world.empty()) {
        host_.storage = event.storage_changed().storage(); // for sessions that connect later
    }
    streams_.publish(std::move(event));
}

void Dispatcher::on_damaged(const simulation::DamagedWorld& damaged) {
    commands_.end_lease(damaged.name);
    streams_.forget_world(damaged.name);
    streams_.publish(protocol::event_of(damaged));
}

bool Dispatcher::ask(Session& session, std::uint64_t request_id, std::string_view world, runtime::Mail mail) {
    if (simulations_.mailbox_of(world).try_push(std::move(mail), session.account())) {
        return true;
    }
    session.answer(protocol::refusing(request_id, mailbox_full(host_.limit_counters)));
    return false;
}

void Dispatcher::ask(Session& session, v1::Request request) {
    const auto shared_request = std::make_shared<const v1::Request>(std::move(request));
    const bool users_only = session.user().role < access::Role::Controller;
    if (ask(session, shared_request->request_id(), protocol::world_of(*shared_request),
            runtime::QueryMail{session.number(), shared_request, users_only, session.account()})) {
        session.requests.query_under_way = true;
        session.requests.expect(held_bytes(*shared_request));
    }
}

void Dispatcher::on_done(runtime::QueryDone done) {
    const SessionPtr session = find_session(sessions_, done.mail.session);
    if (!session) {
        return;
    }
    const v1::Request& request = *done.mail.request;
    session->requests.query_under_way = false;
    session->requests.expect(-held_bytes(request) - held_bytes(done.result));
    count_shortened_answers(done.result, host_.limit_counters);
    protocol::add_rows(done.result, done.response);
    if (const auto* world = std::get_if<protocol::FoundWorld>(&done.result)) {
        const auto refused = request.has_renew_lease() ? commands_.renew_lease(*session, request, world->name)
                                                       : begin_subscription(*session, request, *world, streams_,
                                                                            host_.limit_counters, done.response);
        if (refused) {
            *done.response.mutable_status() = protocol::to_proto(*refused);
        }
    }
    session->answer(std::move(done.response));
    while (!session->requests.query_under_way) {
        auto held_back = session->requests.take_held_back();
        if (!held_back) {
            return;
        }
        serve(*session, *std::move(held_back));
    }
}

void Dispatcher::query(Session& session, v1::Request request) {
    switch (request.kind_case()) {
    case v1::Request::kGetBreeding:
        return find_run(session, std::move(request));
    case v1::Request::kGetMetrics: {
        v1::Response response = response_to(request.request_id());
        *response.mutable_metrics() = metrics_();
        return session.answer(std::move(response));
    }
    case v1::Request::kDescribe: {
        v1::Response response = response_to(request.request_id());
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

void Dispatcher::serve_replay(Session& session, const v1::Request& request) {
    const std::uint64_t id = request.request_id();
    if (request.has_open_replay()) {
        const auto lost =
            replay_places_.take({.session = session.number(), .request_id = id, .account = session.account()});
        if (!lost) {
            host_.limit_counters.met(Limit::Replays);
            return session.answer(protocol::refusing(id, lost.error()));
        }
        if (*lost) {
            end_replay(**lost);
        }
    }
    if (!simulations_.try_send(replay_mail(request, session))) {
        if (request.has_open_replay()) {
            replay_places_.give_back(session.number(), id);
        }
        session.answer(protocol::refusing(id, mailbox_full(host_.limit_counters)));
    }
}

void Dispatcher::end_replay(const ReplayPlaces::Place& place) {
    host_.limit_counters.took_back(Limit::Replays);
    simulations_.end_replay({.session = place.session, .request_id = place.request_id, .name = place.name});
    if (const SessionPtr session = find_session(sessions_, place.session)) {
        session->replays.erase(place.name);
    }
}

void Dispatcher::on_done(const runtime::ReplayEnded& ended) {
    streams_.forget_world(ended.name);
    v1::Event event;
    event.set_world(ended.name);
    *event.mutable_world_deleted()->mutable_by() = protocol::actor_of_kind(v1::ACTOR_KIND_SERVER);
    streams_.publish(std::move(event));
}

void Dispatcher::on_done(runtime::ReplayDone done) {
    const runtime::ReplayMail& mail = done.mail;
    const bool opens = std::holds_alternative<runtime::OpenReplay>(mail.request);
    if (opens && !done.world) {
        replay_places_.give_back(mail.session, mail.request_id);
    } else if (opens && !replay_places_.open(mail.session, mail.request_id, *done.world)) {
        simulations_.end_replay({.name = *done.world}); // it has lost its place while it was being opened
        done.world = runtime::replay_taken_back();
    } else if (done.world && std::holds_alternative<runtime::CloseReplay>(mail.request)) {
        replay_places_.close(*done.world);
    }
    const SessionPtr session = find_session(sessions_, mail.session);
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

void Dispatcher::on_done(runtime::ClassSet done) {
    for (v1::Event& event : done.events) {
        streams_.publish(std::move(event));
    }
    if (const auto waiting = class_waiters_.extract(done.number); !waiting.empty()) {
        waiting.mapped()(done.worlds);
    }
}

void Dispatcher::set_class(const std::string& name, std::optional<simulation::ClassRules> rules, base::Actor by,
                           std::function<void(const std::vector<std::string>& worlds)> done) {
    class_waiters_.emplace(++last_class_change_, std::move(done));
    simulations_.mailbox_of("").push(runtime::SetClass{name, std::move(rules), std::move(by), last_class_change_});
}

void Dispatcher::on_done(const runtime::ReplayMemory& memory) {
    if (const SessionPtr session = find_session(sessions_, memory.session)) {
        session->hold_replays(memory.bytes);
    }
}

void Dispatcher::find_run(Session& session, v1::Request request) {
    const auto shared_request = std::make_shared<const v1::Request>(std::move(request));
    const std::string world = protocol::lookup_name(protocol::world_of(*shared_request));
    if (ask(session, shared_request->request_id(), world, runtime::FindRun{world, session.number(), shared_request})) {
        session.requests.expect(held_bytes(*shared_request));
    }
}

void Dispatcher::on_done(runtime::RunFound done) {
    const SessionPtr session = find_session(sessions_, done.mail.session);
    if (!session) {
        return;
    }
    const v1::Request& request = *std::get<std::shared_ptr<const v1::Request>>(done.mail.purpose);
    const std::uint64_t id = request.request_id();
    session->requests.expect(-held_bytes(request));
    if (!done.run) {
        session->answer(protocol::refusing(id, protocol::with_paths(done.run.error(), protocol::name_of(request))));
    } else if (request.has_export_run()) {
        background_queries_.begin_export(*session, id, done.run->run,
                                         wanted(request.export_run(), session->user().role));
    } else {
        background_queries_.ask_breeding(*session, request, *std::move(done.run));
    }
}

void Dispatcher::forget(const Session& session) {
    background_queries_.forget(session);
    class_requests_.forget(session);
    replay_places_.forget(session.number());
    simulations_.forget(session.number());
}

} // namespace evod::network
