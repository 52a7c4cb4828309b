#include "server/network/commands.h"

#include "server/base/assert.h"
#include "server/log/log.h"
#include "server/protocol/commands.h"
#include "server/protocol/for_each_world.h"
#include "server/protocol/refusals.h"
#include "server/protocol/request_rules.h"
#include "server/runtime/random_ids.h"
#include "server/simulation/world_name.h"

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>

#include <algorithm>
#include <utility>

namespace evod::network {
namespace {

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

/// Exists as long as a command of a session is under way.
class UnderWay {
  public:
    UnderWay(Session& session, std::size_t bytes) : session_{session.weak_from_this()}, bytes_{bytes} {
        session.requests.begin_command(bytes_);
    }
    UnderWay(const UnderWay&) = delete;
    ~UnderWay() {
        if (const auto session = session_.lock()) {
            session->requests.end_command(bytes_);
        }
    }

  private:
    const std::weak_ptr<Session> session_;
    const std::size_t bytes_;
};

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

/// As Session::account() for the session that the actor had.
std::string account_of(const base::Actor& actor) {
    boost::system::error_code error;
    const auto address = asio::ip::make_address(actor.address.substr(0, actor.address.rfind(':')), error);
    return network::account_of(actor.user, error ? actor.address : address_key(address));
}

/// The client_key that a client has sent, by that in a journal.
std::string client_key_of(const std::string& key) {
    return protocol::key_of_batch(key).value_or(key);
}

access::Requester requester_of(const Session& session, const v1::Request& request) {
    return {.user = session.user().name,
            .role = session.user().role,
            .in_own_replay = session.replays.contains(protocol::world_of(request))};
}

UserKey key_of(const run_file::Origin& origin) {
    return {origin.by.user, origin.client_key};
}

} // namespace

base::Refusal mailbox_full(LimitCounters& limit_counters) {
    limit_counters.met(Limit::MailboxCommands);
    return refusal(base::RefusalCode::ResourceExhausted, "the server is busy, its mailbox is full: try again",
                   base::Reason::ServerBusy);
}

Commands::Commands(asio::io_context& context, runtime::Simulations& simulations, Streams& streams,
                   LimitCounters& limit_counters)
    : simulations_{simulations}
    , streams_{streams}
    , limit_counters_{limit_counters}
    , leases_{context,
              [this](const std::string& world, std::uint64_t lease) {
                  limit_counters_.met(Limit::Lease);
                  v1::Request request;
                  request.mutable_release_lease()->set_world(world);
                  handle_own(std::move(request), lease);
              }}
    , reply_cache_{{.kept_per_key = answers_cached_max,
                    .keys_max = client_keys_max,
                    .bytes_max = retry_bytes_max,
                    .evicted_max = evicted_keys_max},
                   [this] { limit_counters_.met(Limit::ClientKeys); }}
    , own_key_{"evod " + to_text(runtime::draw_run_id())} {}

void Commands::restore(const std::vector<run_file::UsedKey>& keys, const std::vector<run_file::JournalEntry>& answers) {
    for (const run_file::UsedKey& key : keys) {
        if (key.by.kind == base::Actor::Kind::Client) {
            reply_cache_.restore_evicted({key.by.user, client_key_of(key.client_key)}, account_of(key.by),
                                         key.highest_id);
        }
    }
    for (const run_file::JournalEntry& entry : answers) {
        if (entry.origin.by.kind != base::Actor::Kind::Client) {
            continue;
        }
        if (const auto key = protocol::key_of_batch(entry.origin.client_key)) {
            // The answer for all worlds is not stored, so a client that sends the request again must read the state.
            reply_cache_.restore_evicted({entry.origin.by.user, *key}, account_of(entry.origin.by),
                                         entry.origin.request_id);
        } else {
            reply_cache_.restore(key_of(entry.origin), account_of(entry.origin.by), entry.origin.request_id,
                                 entry.origin.request, std::make_shared<const std::string>(entry.answer));
        }
    }
}

void Commands::handle(Session& session, const v1::Request& request) {
    const std::uint64_t id = request.request_id();
    const auto refused = [id](const base::Refusal& why) { return protocol::refusing(id, why); };

    if (const auto unknown = protocol::unknown_field_of(request)) {
        return session.answer(refused(
            {.code = base::RefusalCode::Unimplemented,
             .message = "this server does not know a field of the command: it may be older than the client",
             .violations = {{*unknown, "fields of this server's version; Describe lists them", "an unknown field"}},
             .reason = base::Reason::FieldUnknown}));
    }
    std::optional<simulation::Command> command; // nullopt: one for each of several worlds
    if (request.has_for_each_world()) {
        if (const auto why = protocol::refusal_of_action(request)) {
            return session.answer(refused(*why));
        }
    } else if (auto one = protocol::to_command(request, {runtime::draw_seed(), runtime::draw_run_id()})) {
        command = *std::move(one);
    } else {
        count_exceeded_limits(request, limit_counters_);
        return session.answer(refused(one.error()));
    }

    const UserKey key{session.user().name, request.client_key()};
    std::string bytes = bytes_of(request);
    // The command, its bytes in the mail, and those in the reply cache.
    const std::size_t held = request.SpaceUsedLong() + 2 * bytes.size();
    const auto verdict =
        reply_cache_.begin(key, session.account(), id, bytes,
                           [weak = session.weak_from_this(),
                            under_way = std::make_shared<const UnderWay>(session, held)](const auto& frame) {
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
        limit_counters_.met(Limit::CachedAnswers);
        return session.answer(refused(
            refusal(base::RefusalCode::FailedPrecondition,
                    "the request is older than the cached answers and may have been applied; it is not applied again: "
                    "read the current state, and send the command with a higher request_id",
                    base::Reason::RequestTooOld)));
    case ReplyCache::Verdict::New:
        break;
    }
    const bool sent =
        command ? send(*std::move(command), request, std::move(bytes), &session) : send_for_each(request, session);
    if (!sent) {
        reply_cache_.forget(key, id, encode_response(refused(mailbox_full(limit_counters_))));
    }
}

void Commands::handle_own(v1::Request request, std::optional<std::uint64_t> lease) {
    request.set_client_key(own_key_);
    request.set_request_id(++own_request_id_);
    auto command = protocol::to_command(request, {runtime::draw_seed(), runtime::draw_run_id()});
    EVOD_ASSERT(command.has_value());
    if (auto* release = std::get_if<simulation::ReleaseLease>(&*command)) {
        release->lease = lease;
    }
    send(*std::move(command), request, bytes_of(request), nullptr);
}

bool Commands::create_own(v1::Request request, simulation::Ownership ownership) {
    request.set_client_key(own_key_);
    request.set_request_id(++own_request_id_);
    auto command = protocol::to_command(request, {runtime::draw_seed(), runtime::draw_run_id()});
    EVOD_ASSERT(command.has_value());
    std::get<simulation::CreateWorld>(*command).ownership = std::move(ownership);
    return send(*std::move(command), request, bytes_of(request), nullptr);
}

bool Commands::send(simulation::Command command, const v1::Request& request, std::string bytes, const Session* sender) {
    base::Actor by = sender != nullptr ? sender->actor() : base::server_actor();
    if (auto* change = std::get_if<simulation::SetParameters>(&command)) {
        change->by = by;
    }
    return simulations_.try_send(
        runtime::CommandMail{.command = std::move(command),
                             .origin = {.by = std::move(by),
                                        .client_key = request.client_key(),
                                        .request_id = request.request_id(),
                                        .request = std::move(bytes)},
                             .request_name = protocol::name_of(request),
                             .session = sender != nullptr ? sender->number() : 0,
                             .user = sender != nullptr ? sender->account() : "",
                             .requester = sender != nullptr ? requester_of(*sender, request) : access::Requester{},
                             .rules = sender != nullptr ? protocol::rules_of(request) : nullptr});
}

bool Commands::send_for_each(const v1::Request& request, const Session& sender) {
    const std::uint64_t batch = ++last_batch_;
    runtime::Mail mail = runtime::ForEachWorld{.class_name = request.for_each_world().class_(),
                                               .request = std::make_shared<const v1::Request>(request),
                                               .by = sender.actor(),
                                               .session = sender.number(),
                                               .user = sender.account(),
                                               .requester = requester_of(sender, request),
                                               .batch = batch};
    if (!simulations_.mailbox_of("").try_push(std::move(mail), sender.account())) {
        return false;
    }
    batches_.emplace(batch, Batch{{sender.user().name, request.client_key()}, request.request_id(), {}, {}});
    return true;
}

void Commands::on_begun(runtime::BatchBegun begun) {
    batches_.find(begun.batch)->second.worlds = std::move(begun.worlds);
    answer_if_complete(begun.batch);
}

void Commands::on_one_done(const runtime::CommandDone& done) {
    v1::WorldResult result;
    result.set_world(std::visit(
        [](const auto& command) {
            if constexpr (requires { command.world; }) {
                return command.world;
            }
            return std::string{};
        },
        done.mail.command));
    if (done.outcome) {
        result.set_applied_tick(done.outcome->tick);
    } else {
        *result.mutable_status() =
            protocol::to_proto(protocol::with_paths(done.outcome.error(), done.mail.request_name));
    }
    batches_.find(done.mail.batch)->second.done[result.world()] = result;
    answer_if_complete(done.mail.batch);
}

void Commands::answer_if_complete(std::uint64_t batch) {
    const auto found = batches_.find(batch);
    const Batch& each = found->second;
    if (!each.worlds || each.done.size() < each.worlds->size()) {
        return;
    }
    v1::Response response = response_to(each.request_id);
    v1::WorldResults& results = *response.mutable_world_results();
    for (const std::string& world : *each.worlds) {
        *results.add_results() = each.done.find(world)->second;
    }
    reply_cache_.finish(each.key, each.request_id, encode_response(response));
    batches_.erase(found);
}

void Commands::on_done(runtime::CommandDone done) {
    const runtime::CommandMail& mail = done.mail;
    const auto frame = std::make_shared<const std::string>(std::move(done.frame));
    if (mail.batch != 0) {
        on_one_done(done);
    }
    if (!done.outcome) {
        return mail.batch != 0 ? void() : on_refused(mail, done.outcome.error(), frame);
    }
    if (mail.session != 0 &&
        mail.batch == 0) { // the server sends each of its own commands once, so they have no entry in the cache
        reply_cache_.finish(key_of(mail.origin), mail.origin.request_id, frame);
    }
    const std::string& world = done.outcome->world;
    if (std::holds_alternative<simulation::DeleteWorld>(mail.command)) {
        streams_.forget_world(world);
    }
    if (done.event) {
        streams_.publish(*std::move(done.event));
    }
    if (!done.lease) {
        leases_.end(world);
    } else if (std::holds_alternative<simulation::RunUntilTick>(mail.command) && grants_leases_) {
        leases_.begin(world, *done.lease, key_of(mail.origin));
    }
}

void Commands::on_refused(const runtime::CommandMail& mail, const base::Refusal& why, const SharedBytes& frame) {
    if (mail.session == 0) {
        // The world of a member of a class is there already each time the member connects again.
        const auto* create = std::get_if<simulation::CreateWorld>(&mail.command);
        const bool is_there =
            create != nullptr && !create->ownership.class_name.empty() && why.reason == base::Reason::WorldExists;
        if (why.reason != base::Reason::NoLease && !is_there) {
            log::error("the server's own command {} is refused: {}", mail.request_name, to_text(why));
        }
        return;
    }
    log_refusal(mail.session, to_text(mail.origin.by), mail.origin.request_id, why);
    if (why.reason == base::Reason::PlannedChangesMax) {
        limit_counters_.met(Limit::PlannedChanges);
    } else if (why.reason == base::Reason::PlacedMax) {
        limit_counters_.met(Limit::Placed);
    } else if (why.reason == base::Reason::WorldsMax) {
        limit_counters_.met(Limit::Worlds);
    }
    // A temporary refusal is not cached, so the same request may succeed when the client sends it again.
    if (why.code == base::RefusalCode::Unavailable || why.code == base::RefusalCode::ResourceExhausted) {
        reply_cache_.forget(key_of(mail.origin), mail.origin.request_id, frame);
    } else {
        reply_cache_.finish(key_of(mail.origin), mail.origin.request_id, frame);
    }
}

std::optional<base::Refusal> Commands::renew_lease(const Session& session, const v1::Request& request,
                                                   const std::string& world) {
    const std::string& key = request.client_key();
    if (leases_.renew(world, {session.user().name, key})) {
        return std::nullopt;
    }
    return base::Refusal{.code = base::RefusalCode::FailedPrecondition,
                         .message = "this client_key has no lease of that world: it gets one with "
                                    "run_until_tick on a running world",
                         .violations = {{"client_key", "the key of the run_until_tick", key}},
                         .reason = base::Reason::NoLease};
}

void Commands::end_all_leases() {
    grants_leases_ = false;
    leases_.end_all();
}

} // namespace evod::network
