#include "server/runtime/seeks.h"

#include "server/base/inline_executor.h"
#include "server/base/within_memory.h"
#include "server/simulation/world_bytes.h"

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

namespace evod::runtime {
namespace {

using base::RefusalCode;

bool is_over(const replay::SeekStart& seek) {
    const simulation::Moment& now = seek.from.world().moment();
    return now.generation > seek.to.generation || (now.generation == seek.to.generation && now.tick >= seek.to.tick);
}

/// Simulates one tick of a seek.
///
/// returns  whether the seek has ended. Every seek ends, whatever its target is.
bool advance_tick(replay::SeekStart& seek, base::Executor& executor) {
    const simulation::World& world = seek.from.world();
    if (is_over(seek)) {
        return true;
    }
    if (world.moment().generation < seek.to.generation && world.generation_over()) {
        seek.from.breed_next_generation(executor);
    } else if (world.outcome() == evolution::Outcome::Running) {
        seek.from.advance_tick(executor);
        if (seek.from.changes().fault()) {
            return true; // the file is damaged; result_of() reports it
        }
    } else {
        return true; // the run ends before the target; result_of() reports it
    }
    return is_over(seek);
}

base::Result<SeekResult> result_of(replay::SeekStart seek) {
    const simulation::Moment& there = seek.from.world().moment();
    if (there.generation == seek.to.generation && there.tick == seek.to.tick) {
        return SeekResult{std::move(seek.from), std::move(seek.there)};
    }
    if (const auto& fault = seek.from.changes().fault()) {
        return *fault;
    }
    return refusal(RefusalCode::DataLoss,
                   "the run file contains this moment, but a new simulation of the run does not reach it");
}

base::Refusal superseded() {
    return refusal(RefusalCode::FailedPrecondition,
                   "superseded by a later seek: seek again if this moment is still wanted",
                   base::Reason::SeekSuperseded);
}

} // namespace

base::Result<FileReplay> FileReplay::open(const std::string& path, std::optional<std::uint64_t> generation,
                                          base::Executor& executor) {
    auto run = replay::StoredRun::of_file(path);
    if (!run) {
        return run.error();
    }
    const auto name = run->world_name();
    if (!name) {
        return name.error();
    }
    std::optional<replay::WantedMoment> wanted;
    if (generation) {
        wanted = replay::WantedMoment{.generation = generation, .tick = {}};
    }
    auto seek = run->start_seek(wanted, {}, executor);
    if (!seek) {
        return seek.error();
    }
    while (!advance_tick(*seek, executor)) {
    }
    return FileReplay{*name, *std::move(run), {std::move(seek->from), std::move(seek->there)}};
}

bool Seeks::Purpose::opens_replay() const {
    const auto* mail = std::get_if<ReplayMail>(&request);
    return mail != nullptr && std::holds_alternative<OpenReplay>(mail->request);
}

std::uint64_t Seeks::Purpose::session() const {
    const auto* mail = std::get_if<ReplayMail>(&request);
    return mail != nullptr ? mail->session : 0;
}

std::string Seeks::Purpose::user() const {
    const auto* mail = std::get_if<ReplayMail>(&request);
    return mail != nullptr ? mail->user : std::get<CommandMail>(request).user;
}

void Seeks::begin(Request request) {
    if (const std::string& moved = request.purpose.replay; !moved.empty()) {
        cancel([&](const Running& other) { return !other.at && other.request.purpose.replay == moved; }, superseded());
    }
    std::string user = request.purpose.user();
    const auto seek =
        seeks_.emplace(++last_number_, Running{.request = std::move(request), .user = std::move(user)}).first;
    const Request& begun = seek->second.request;
    seek->second.reading =
        jobs_.add(seek->second.user, [&mailbox = mailbox_, number = seek->first, run = begun.run, to = begun.to,
                                      until = begun.until](const base::StopCheck& stop) {
            base::InlineExecutor executor;
            mailbox.push(SeekRead{number, std::make_shared<base::Result<replay::SeekStart>>(base::within_memory(
                                              [&] { return run.start_seek(to, until, executor, stop); }))});
        });
}

std::uint64_t Seeks::take(const SeekRead& mail) {
    const auto seek = seeks_.find(mail.seek);
    if (seek == seeks_.end()) {
        return 0; // it was cancelled
    }
    const std::uint64_t session = seek->second.request.purpose.session();
    if (!*mail.start) {
        end(seek, mail.start->error());
        return session;
    }
    if (const std::string& moved = seek->second.request.purpose.replay; !moved.empty()) {
        cancel([&](const Running& other) { return other.at && other.request.purpose.replay == moved; }, superseded());
    }
    seek->second.at = *std::move(*mail.start);
    return session;
}

void Seeks::end(std::map<std::uint64_t, Running>::iterator seek, base::Result<SeekResult> result) {
    seek->second.reading.request_stop();
    ended_.push_back({std::move(seek->second.request), std::move(result)});
    seeks_.erase(seek);
}

void Seeks::cancel(const std::function<bool(const Running&)>& is_wanted, const base::Refusal& why) {
    for (auto seek = seeks_.begin(); seek != seeks_.end();) {
        const auto next = std::next(seek);
        if (is_wanted(seek->second)) {
            end(seek, why);
        }
        seek = next;
    }
}

void Seeks::cancel_opening(std::uint64_t session, std::uint64_t request_id, const base::Refusal& why) {
    cancel(
        [&](const Running& seek) {
            const auto* mail = std::get_if<ReplayMail>(&seek.request.purpose.request);
            return mail != nullptr && mail->session == session && mail->request_id == request_id &&
                   seek.request.purpose.opens_replay();
        },
        why);
}

void Seeks::cancel_of_session(std::uint64_t session) {
    cancel([&](const Running& seek) { return seek.request.purpose.session() == session; },
           refusal(RefusalCode::NotFound, "the session that sent the request has ended"));
}

void Seeks::cancel_of_replay(const std::string& replay) {
    cancel([&](const Running& seek) { return seek.request.purpose.replay == replay; },
           refusal(RefusalCode::NotFound, "the replay has been closed: open it again", base::Reason::WorldNotFound));
}

std::size_t Seeks::held_bytes(std::uint64_t session) const {
    std::size_t bytes = 0;
    for (const auto& [number, seek] : seeks_) {
        if (seek.at && seek.request.purpose.session() == session) {
            bytes += simulation::estimated_bytes(seek.at->from.world()) + seek.at->from.changes().held_bytes();
        }
    }
    return bytes;
}

bool Seeks::under_way() const {
    return std::ranges::any_of(seeks_, [](const auto& item) { return item.second.at.has_value(); });
}

void Seeks::advance(std::uint64_t number, const std::function<bool()>& stop) {
    const auto seek = seeks_.find(number);
    do {
        if (advance_tick(*seek->second.at, executor_)) {
            return end(seek, result_of(*std::move(seek->second.at)));
        }
    } while (!stop());
}

} // namespace evod::runtime
