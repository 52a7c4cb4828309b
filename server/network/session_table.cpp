#include "server/network/session_table.h"

#include "server/base/quota.h"
#include "server/classes/class.h"

#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace evod::network {
namespace {

base::Refusal to_make_room(const std::string& why) {
    return refusal(base::RefusalCode::ResourceExhausted, why, base::Reason::SessionsMax);
}

/// What the accounts hold of a pool of so many places. Counts the sessions with a Hello, or those without one.
base::Quota held_by(const Sessions& sessions, bool greeted, std::size_t total) {
    base::Quota held{total};
    for (const auto& [number, session] : sessions) {
        if (session->greeted() == greeted && !session->is_over()) {
            held.take(session->account());
        }
    }
    return held;
}

} // namespace

void SessionTable::accept(std::unique_ptr<Transport> transport) {
    limit_farewells();
    const auto session = std::make_shared<Session>(std::move(transport), host_, ++last_number_);
    host_.traffic.connections.add();
    const base::Quota present = newcomers();
    const auto verdict = present.ask(session->account());
    if (verdict != base::Quota::Verdict::Free) {
        host_.limit_counters.met(Limit::Newcomers);
        const std::string& from = verdict == base::Quota::Verdict::UserFull ? session->account() : present.largest();
        const auto oldest = std::ranges::find_if(sessions_, [&](const auto& other) {
            return !other.second->greeted() && !other.second->is_over() && other.second->account() == from;
        });
        oldest->second->fail(
            to_make_room("no Hello was received, and another connection needs the place: connect again "
                         "and send a Hello at once"));
    }
    sessions_.emplace(session->number(), session);
    session->start(going_away_ ? std::optional{refusal(base::RefusalCode::Unavailable,
                                                       "the server is shutting down: connect again after the restart",
                                                       base::Reason::ServerGoingAway)}
                               : std::nullopt);
}

void SessionTable::limit_farewells() {
    const auto is_ending = [](const auto& session) { return session.second->is_over(); };
    if (static_cast<std::size_t>(std::ranges::count_if(sessions_, is_ending)) >= farewells_max) {
        std::ranges::find_if(sessions_, is_ending)->second->close();
    }
}

void SessionTable::end_oldest_of_member(const std::string& account) {
    std::vector<SessionPtr> open;
    for (const auto& [number, session] : sessions_) {
        if (session->greeted() && !session->is_over() && session->account() == account) {
            open.push_back(session);
        }
    }
    if (open.size() >= classes::member_sessions_max) {
        host_.limit_counters.took_back(Limit::MemberSessions);
        open.front()->fail(to_make_room("you have connected elsewhere: a member of a class has at most " +
                                        std::to_string(classes::member_sessions_max) + " sessions"));
    }
}

std::optional<base::Refusal> SessionTable::make_room(const std::string& account) {
    if (classes::is_member_name(account)) {
        end_oldest_of_member(account);
    }
    const base::Quota held = places();
    const auto verdict = held.ask(account);
    if (verdict == base::Quota::Verdict::Free) {
        return std::nullopt;
    }
    const auto is_idle_of_largest = [&](const auto& other) {
        const Session& session = *other.second;
        return session.greeted() && !session.is_over() && session.account() == held.largest() &&
               session.requests.commands_under_way == 0;
    };
    const auto oldest = verdict == base::Quota::Verdict::FromLargest
                            ? std::ranges::find_if(sessions_, is_idle_of_largest)
                            : sessions_.end();
    if (oldest != sessions_.end()) {
        host_.limit_counters.took_back(Limit::Sessions);
        oldest->second->fail(to_make_room("another user needs the place, and this user has the most sessions"));
        return std::nullopt;
    }
    host_.limit_counters.met(Limit::Sessions);
    return verdict == base::Quota::Verdict::UserFull
               ? base::limit_refusal("there are " + std::to_string(held.share()) +
                                         " sessions of this user, or from this address without a token: end one of "
                                         "them first",
                                     base::Reason::SessionsMax, "sessions_max", held.held(account), held.share())
               : base::limit_refusal("the server has " + std::to_string(sessions_max_) +
                                         " sessions: try again when one has ended",
                                     base::Reason::SessionsMax, "sessions_max", held.held(), held.total());
}

base::Quota SessionTable::places() const {
    return held_by(sessions_, true, sessions_max_);
}

base::Quota SessionTable::newcomers() const {
    return held_by(sessions_, false, newcomers_max);
}

void SessionTable::forget(const Session& session) {
    ++ended_count_;
    sessions_.erase(session.number());
}

void SessionTable::evict() {
    struct Held {
        SessionPtr session;
        std::size_t bytes;
        bool has_command;
    };
    base::Quota users{host_.send_memory.bytes_max()};
    std::map<std::string, std::vector<Held>> sessions_of; // key: the account; the session to close first is the last
    std::map<std::uint64_t, std::size_t> shared;
    if (host_.shared_snapshot_bytes) {
        shared = host_.shared_snapshot_bytes();
    }
    for (const auto& [number, session] : sessions_) {
        if (const std::size_t bytes = session->held_bytes() + shared[number]; bytes > 0) {
            users.take(session->account(), bytes);
            sessions_of[session->account()].push_back({session, bytes, session->requests.commands_under_way > 0});
        }
    }
    for (auto& [account, sessions] : sessions_of) {
        std::ranges::sort(sessions, {}, [](const Held& held) { return std::pair{!held.has_command, held.bytes}; });
    }
    const std::size_t all_mib = host_.send_memory.bytes_max() >> 20;
    const std::string of_user = "the sessions of one user use more than " + std::to_string(all_mib / 2) + " MiB",
                      of_all = "all sessions use more than " + std::to_string(all_mib) + " MiB";
    std::size_t excess = host_.send_memory.excess();
    const auto is_over = [&] {
        const std::string& account = users.largest();
        if (account.empty() || excess > 0) {
            return account.empty();
        }
        const std::size_t most = std::ranges::max(sessions_of.at(account), {}, &Held::bytes).bytes;
        return users.held(account) <= users.share() || users.held(account) - most <= users.share() / 16;
    };
    while (!is_over()) {
        const std::string account = users.largest();
        const Held held = sessions_of.at(account).back();
        sessions_of.at(account).pop_back();
        held.session->evict(users.held(account) > users.share() ? of_user : of_all, held.bytes);
        users.give_back(account, held.bytes);
        excess -= std::min(excess, held.bytes);
    }
}

} // namespace evod::network
