#include "tests/fuzz/watched_server.h"

#include "server/protocol/answers.h"
#include "server/protocol/queries.h"
#include "server/protocol/worlds.h"
#include "server/runtime/random_ids.h"
#include "tests/fuzz/valid_snapshot.h"

#include <boost/asio/post.hpp>

#include <cerrno>
#include <type_traits>
#include <variant>
#include <vector>

// ---- replacements that make a script reproducible
// --------------------------------------------------------------------------

evod::support::ManualClock& evod::fuzz::clock() {
    static support::ManualClock clock;
    return clock;
}

// Replaces the library's function in the whole program.
std::chrono::steady_clock::time_point std::chrono::steady_clock::now() noexcept {
    return evod::fuzz::clock().now();
}

// Asio normally uses timers of the kernel, which has another clock. Without timerfd it reads the clock itself.
extern "C" int timerfd_create(int, int) noexcept {
    errno = ENOSYS;
    return -1;
}

namespace {
std::uint64_t drawn = 0;
} // namespace

// Replaces server/runtime/random_ids.cpp.
evod::base::Seed evod::runtime::draw_seed() {
    return {++drawn};
}
evod::simulation::RunId evod::runtime::draw_run_id() {
    return {0, ++drawn};
}

namespace evod::fuzz {
namespace {

/// Larger worlds would take too long; the harness refuses them like a full machine.
struct Bound {
    const char* parameter;
    double max;
};
constexpr Bound bounds[] = {{"population_size", 8},    {"island_count", 3},          {"food_count", 16},
                            {"poison_count", 16},      {"obstacle_count", 2},        {"crate_count", 2},
                            {"tournament_size", 8},    {"scale_with_population", 0}, {"island_width_px", 4000},
                            {"island_height_px", 4000}};

bool beyond(const Bound& bound, const parameters::ParameterValue& value) {
    return std::visit(
        [&](const auto& given) {
            if constexpr (std::is_arithmetic_v<std::decay_t<decltype(given)>>) {
                return static_cast<double>(given) > bound.max;
            } else {
                return false;
            }
        },
        value);
}

bool too_large(const simulation::Command& command) {
    return std::ranges::any_of(bounds, [&](const Bound& bound) {
        if (const auto* create = std::get_if<simulation::CreateWorld>(&command)) {
            return beyond(bound, parameters::find_parameter(bound.parameter)->get(create->parameters));
        }
        const auto* set = std::get_if<simulation::SetParameters>(&command);
        return set != nullptr && std::ranges::any_of(set->assignments, [&](const parameters::Assignment& assignment) {
                   return assignment.name == bound.parameter && beyond(bound, assignment.value);
               });
    });
}

/// Such commands only decide when a world advances.
bool is_run_control(const simulation::Command& command) {
    using namespace simulation;
    return std::holds_alternative<Run>(command) || std::holds_alternative<RunUntilTick>(command) ||
           std::holds_alternative<ReleaseLease>(command) || std::holds_alternative<Pause>(command) ||
           std::holds_alternative<Resume>(command) || std::holds_alternative<SetSpeed>(command);
}

} // namespace

base::Result<access::AuthenticatedUser> admit(const std::string& token) {
    if (const auto role = access::role_named(token)) {
        return access::AuthenticatedUser{.name = token, .role = *role};
    }
    return base::refusal(base::RefusalCode::Unauthenticated, "the token is not known");
}

WatchedServer::WatchedServer()
    : send_memory_{2 * network::client_buffer_bytes_max, [] { require(false); }}
    // a script leaves less than this unread
    , outbox_{[this] { boost::asio::post(context_, [this] { deliver(); }); }}
    , streams_{sessions_, simulations_, send_memory_}
    , dispatcher_{context_,
                  simulations_,
                  outbox_,
                  sessions_,
                  streams_,
                  host_,
                  network::LimitOptions{}.replays_max,
                  classes_,
                  [this] { boost::asio::post(context_, [this] { go_away(); }); },
                  [] { return v1::Metrics{}; }}
    , loop_{{mailbox_, simulations_.part_of("").demand, executor_, clock()},
            {.events = streams_.outlet(outbox_),
             .snapshot = [this](runtime::SnapshotPtr snapshot) { outbox_.snapshot(std::move(snapshot)); },
             .reply = [this](runtime::Reply reply) { check_reply(std::move(reply)); }}}
    , replays_{{simulations_.mailbox_of("w@1"), simulations_.part_of("w@1").demand, executor_, clock()},
               {.events = [](auto&&...) {},
                .snapshot = [](runtime::SnapshotPtr) {},
                .reply = [this](runtime::Reply reply) { outbox_.reply(std::move(reply)); }},
               simulations_.job_turns()} {
    drawn = 0;
    host_.limits = network::limits_message({});
    host_.instance_id = "fuzz";
    host_.clock = &clock();
    host_.handle = [this](network::Session& session, v1::Request request) {
        dispatcher_.handle(session, std::move(request));
    };
    host_.admit = [](const std::string& token, const std::string&) { return admit(token); };
    host_.ended = [this](network::Session& session) {
        --connection_count_;
        dispatcher_.forget(session);
        sessions_.erase(session.number());
        streams_.forget(session);
    };
}

void WatchedServer::accept(int descriptor, const std::optional<base::Refusal>& refusal) {
    network::tcp::socket socket{context_};
    socket.assign(network::tcp::v4(), descriptor); // another family, but no code reads it
    const auto session = std::make_shared<network::Session>(std::move(socket), host_, ++session_number_);
    ++connection_count_;
    if (!refusal) {
        sessions_.emplace(session->number(), session);
    }
    session->start(refusal);
}

void WatchedServer::poll() {
    context_.restart();
    context_.poll();
    const auto now = clock().now();
    for (const auto& [number, session] : sessions_) {
        session->check_progress(now - polled_);
    }
    polled_ = now;
}

void WatchedServer::pass() {
    if (going_away_) {
        return;
    }
    watch_mail();
    loop_.pass();
    replays_.pass();
}

void WatchedServer::watch_mail() {
    if (!mailbox_.pending()) {
        return;
    }
    std::vector<runtime::Mail> waiting = mailbox_.drain();
    mailbox_.wake();
    for (runtime::Mail& mail : waiting) {
        if (auto* command = std::get_if<runtime::CommandMail>(&mail)) {
            const run_file::Origin& origin = command->origin;
            require(carried_out_.emplace(origin.by.user, origin.client_key, origin.request_id).second);
            if (too_large(command->command)) {
                const base::Result<simulation::Applied> refused =
                    base::refusal(base::RefusalCode::ResourceExhausted, "the world is too large");
                const v1::Response answer =
                    protocol::answer_of(command->origin.request_id, command->request_name, loop_.laboratory(), refused);
                outbox_.reply(runtime::CommandDone{
                    .mail = std::move(*command), .outcome = refused, .frame = protocol::frame_of(answer)});
                continue;
            }
            mailbox_.push(runtime::Ping{});
        } else if (std::holds_alternative<runtime::ForkWorldComputed>(mail)) {
            mailbox_.push(runtime::Ping{}); // the end of a command, too
        }
        mailbox_.push(std::move(mail));
    }
}

void WatchedServer::check_reply(runtime::Reply reply) {
    if (std::holds_alternative<runtime::Pong>(reply)) {
        state_before_ = state_of_all(); // the next mail is a command
        return;
    }
    if (const auto* done = std::get_if<runtime::CommandDone>(&reply)) {
        if (done->outcome) {
            follow(done->mail.command, *done->outcome);
        } else {
            require(done->mail.batch != 0 ||
                    state_of_all() == state_before_); // another world of a batch may have changed
        }
    }
    outbox_.reply(std::move(reply));
}

std::string WatchedServer::state_of_all() const {
    return protocol::list_worlds(loop_.laboratory()).SerializeAsString();
}

void WatchedServer::follow(const simulation::Command& command, const simulation::Applied& applied) {
    if (is_run_control(command)) {
        return;
    }
    if (const auto* set = std::get_if<simulation::SetParameters>(&command); set != nullptr && set->dry_run) {
        return;
    }
    // First advance twins that continue.
    const auto* fork = std::get_if<simulation::ForkWorld>(&command);
    if (fork != nullptr || std::holds_alternative<simulation::SetParameters>(command)) {
        const auto origin = loop_.laboratory().find(fork != nullptr ? fork->world : applied.world);
        require(origin.has_value());
        simulation::Entry& twin = catch_up(**origin);
        if (fork != nullptr && fork->at_generation) {
            require(twins_.adopt(*fork, twin.world.at_its_opening(executor_)).has_value());
            return;
        }
    }
    const auto same = twins_.apply(command);
    require(same && same->world == applied.world);
}

simulation::Entry& WatchedServer::catch_up(const simulation::Entry& entry) {
    const auto twin = twins_.find(entry.name);
    require(twin && (*twin)->run_id == entry.run_id);
    simulation::World& world = (*twin)->world;
    while (world.moment().tick < entry.world.moment().tick) {
        world.advance_tick(executor_);
    }
    return **twin;
}

void WatchedServer::compare_with_twins() {
    require(loop_.laboratory().entries().size() == twins_.entries().size());
    for (const auto& entry : loop_.laboratory().entries()) {
        const simulation::World& twin = catch_up(*entry).world;
        require(twin.moment().tick == entry->world.moment().tick && twin.hash() == entry->world.hash());
    }
}

void WatchedServer::deliver() {
    runtime::Outbox::Taken taken = outbox_.take();
    dispatcher_.deliver(std::move(taken.deliveries));
    streams_.deliver(std::move(taken));
    while (streams_.send_some(clock().now())) {
        // Until none is left.
    }
}

void WatchedServer::go_away() {
    if (std::exchange(going_away_, true)) {
        return;
    }
    dispatcher_.refuse_all();
    watch_mail();
    loop_.close();
    deliver();
    streams_.announce_end();
    streams_.end_sessions();
}

} // namespace evod::fuzz
