#include "server/runtime/time_travel.h"

#include "server/base/inline_executor.h"
#include "server/base/within_memory.h"

#include <algorithm>
#include <memory>
#include <utility>

namespace evod::runtime {

using base::Refusal;
using base::RefusalCode;
using base::Result;

namespace {

/// A field of a RunMoment is known to clients by its path.
Refusal within(Refusal refused, const std::string& field) {
    for (base::Violation& violation : refused.violations) {
        violation.field = field + "." + violation.field;
    }
    return refused;
}

Refusal superseded() {
    return refusal(RefusalCode::FailedPrecondition,
                   "superseded by a later seek: seek again if this moment is still wanted",
                   base::Reason::SeekSuperseded);
}

Refusal owner_gone() {
    return refusal(RefusalCode::NotFound, "the session that asked for it has ended");
}

Refusal closed_since() {
    return refusal(RefusalCode::NotFound, "the past has been closed: open it again", base::Reason::WorldNotFound);
}

} // namespace

Result<TimeTravel::Replay> TimeTravel::replay_of(const std::string& path, std::optional<std::uint64_t> generation,
                                                 base::Executor& executor) {
    auto past = replay::Past::of_file(path);
    if (!past) {
        return past.error();
    }
    const auto name = past->world_name();
    if (!name) {
        return name.error();
    }
    std::optional<replay::WantedMoment> wanted;
    if (generation) {
        wanted = replay::WantedMoment{.generation = generation, .tick = {}};
    }
    auto departure = past->depart(wanted, {}, executor);
    if (!departure) {
        return departure.error();
    }
    Journey journey{.number = 0,
                    .owner = 0,
                    .rerun = std::move(departure->from),
                    .to = departure->to,
                    .there = std::move(departure->there),
                    .arrived = {}};
    while (!advance(journey, executor)) {
    }
    return Replay{*name, *std::move(past), std::move(journey.rerun), std::move(journey.there)};
}

void TimeTravel::show(Replay replay) {
    show(replay.name, std::move(replay.past), 0, {std::move(replay.rerun), std::move(replay.replay)});
}

void TimeTravel::show(const std::string& name, replay::Past past, std::uint64_t owner, Arrival arrival) {
    simulation::RunControl control;
    control.endless = control.paused = true;
    const replay::ComingChanges& changes = arrival.rerun.changes();
    looks_.emplace(name, Look{past, changes, changes.last_entry(), owner, {}, false, 0});
    laboratory_.adopt(std::make_unique<simulation::Entry>(simulation::Entry{
        name, past.run_id(), control, std::move(arrival.rerun).take(), 0, false, std::move(arrival.there)}));
    (void)entry_of(name)->world.take_events(); // of the way there
}

simulation::Entry* TimeTravel::entry_of(const std::string& world) {
    const auto found = laboratory_.find(world);
    return found ? *found : nullptr;
}

void TimeTravel::apply(PastMail mail) {
    if (const auto* open_replay = std::get_if<OpenReplay>(&mail.request)) {
        return open(*open_replay, mail.reply);
    }
    if (const auto* seek_moment = std::get_if<Seek>(&mail.request)) {
        return seek(*seek_moment, mail.reply);
    }
    if (const auto* close_replay = std::get_if<CloseReplay>(&mail.request)) {
        return mail.reply(laboratory_, close(*close_replay));
    }
    close_all_of(std::get<OwnerGone>(mail.request).owner);
}

void TimeTravel::find_run(const FindRun& mail) {
    const auto entry = std::as_const(laboratory_).find(mail.world);
    if (!entry) {
        return mail.found(entry.error());
    }
    const auto past = replay_of((*entry)->name);
    if (!past) {
        return mail.found(past.error());
    }
    once_written((*entry)->name, [found = mail.found,
                                  run = FoundRun{*past, (*entry)->world.moment().generation}](bool) { found(run); });
}

Result<replay::Past> TimeTravel::replay_of(const std::string& world) const {
    const auto entry = std::as_const(laboratory_).find(world);
    if (!entry) {
        return entry.error();
    }
    if (const auto look = looks_.find((*entry)->name); look != looks_.end()) {
        return look->second.past;
    }
    if (!recorder_) {
        return refusal(RefusalCode::FailedPrecondition,
                       "this server keeps no runs, so nothing tells of their past: start it without --keep-nothing",
                       base::Reason::RunsNotKept);
    }
    return replay::Past{recorder_->paths_of((*entry)->name, (*entry)->run_id), (*entry)->run_id};
}

void TimeTravel::once_written(const std::string& world, std::function<void(bool)> then) {
    recording::RunRecorder* recorder = recorder_ ? recorder_->of(world) : nullptr;
    if (!recorder || recorder_->refusal()) {
        return then(false); // what is in the file is what there is
    }
    const std::uint64_t number = ++last_waiting_;
    waiting_.emplace(number, std::move(then));
    recorder->once_written([this, number] {
        mailbox_.push(CallMail{[this, number] {
            if (auto waited = waiting_.extract(number)) {
                waited.mapped()(true);
            }
        }});
    });
}

replay::KnownUntil TimeTravel::known_of(const std::string& world, const simulation::RunId& run_id) const {
    const auto living = std::as_const(laboratory_).find(world);
    if (!living || (*living)->replay || (*living)->run_id != run_id) {
        return {};
    }
    const simulation::Moment& now = (*living)->world.moment();
    return {.generation = now.generation, .tick = now.tick};
}

void TimeTravel::stop_waiting() {
    for (const auto& [number, then] : std::exchange(waiting_, {})) {
        then(false);
    }
}

void TimeTravel::set_out(const replay::Past& past, const std::optional<replay::WantedMoment>& to,
                         replay::KnownUntil known, std::uint64_t owner, Arrived arrived, const Departed& departed) {
    if (departing_.size() + journeys_.size() >= journeys_max) {
        return arrived(refusal(RefusalCode::ResourceExhausted, "too many are on their way into the past: try again",
                               base::Reason::PastsMax));
    }
    const std::uint64_t number = ++last_journey_;
    departing_.emplace(number, Departing{.owner = owner, .departed = departed, .arrived = std::move(arrived)});
    reader_.ask([this, number, past, to, known]() -> PastReader::Then {
        base::InlineExecutor executor;
        const auto departure = std::make_shared<Result<replay::Departure>>(
            base::within_memory([&] { return past.depart(to, known, executor); }));
        return [this, number, departure] { depart(number, std::move(*departure)); };
    });
}

void TimeTravel::depart(std::uint64_t number, Result<replay::Departure> departure) {
    const auto found = departing_.extract(number);
    if (!found) { // its owner is gone
        return;
    }
    Departing departing = std::move(found.mapped());
    if (!departure) {
        return departing.arrived(departure.error());
    }
    if (departing.departed && !departing.departed(number)) {
        return departing.arrived(closed_since());
    }
    journeys_.push_back({.number = number,
                         .owner = departing.owner,
                         .rerun = std::move(departure->from),
                         .to = departure->to,
                         .there = std::move(departure->there),
                         .arrived = std::move(departing.arrived)});
}

void TimeTravel::give_up(std::uint64_t number, const Refusal& why) {
    const auto journey = std::ranges::find(journeys_, number, &Journey::number);
    if (journey == journeys_.end()) {
        return;
    }
    const Arrived gave_up = std::move(journey->arrived);
    journeys_.erase(journey);
    gave_up(why);
}

void TimeTravel::begin_journey(const std::string& world, std::uint64_t generation, Arrived arrived) {
    const auto past = replay_of(world);
    if (!past) {
        return arrived(past.error());
    }
    const auto known = known_of(world, past->run_id());
    once_written(world, [this, generation, known, past = *past, arrived = std::move(arrived)](bool all_is_written) {
        set_out(past, replay::WantedMoment{.generation = generation, .tick = {}},
                all_is_written ? known : replay::KnownUntil{}, 0, arrived);
    });
}

bool TimeTravel::is_over(const Journey& journey) {
    const simulation::Moment& now = journey.rerun.world().moment();
    return now.generation > journey.to.generation ||
           (now.generation == journey.to.generation && now.tick >= journey.to.tick);
}

bool TimeTravel::advance(Journey& journey, base::Executor& executor) {
    const simulation::World& world = journey.rerun.world();
    const simulation::Moment& now = world.moment();
    if (is_over(journey)) {
        return true;
    }
    if (now.generation < journey.to.generation && world.generation_over()) {
        journey.rerun.turn_over(executor);
    } else if (world.outcome() == evolution::Outcome::Running) {
        journey.rerun.advance_tick(executor);
    } else {
        return true; // the run was over before: whoever arrives sees that
    }
    return is_over(journey);
}

void TimeTravel::travel(const std::function<bool()>& stop) {
    for (std::size_t next = 0; !journeys_.empty() && (next == 0 || !stop()); ++next) {
        const std::size_t i = next % journeys_.size();
        if (!advance(journeys_[i], executor_)) {
            continue;
        }
        Journey journey = std::move(journeys_[i]);
        journeys_.erase(journeys_.begin() + static_cast<std::ptrdiff_t>(i));
        const simulation::Moment& there = journey.rerun.world().moment();
        if (there.generation == journey.to.generation && there.tick == journey.to.tick) {
            journey.arrived(Arrival{std::move(journey.rerun), std::move(journey.there)});
        } else {
            journey.arrived(refusal(RefusalCode::DataLoss,
                                    "simulated again, the run does not come to the moment that its file contains"));
        }
    }
}

void TimeTravel::arrive_in(simulation::Entry& entry, Look& look, Arrival arrival) {
    look.changes = arrival.rerun.changes();
    look.entries_read = look.changes.last_entry();
    look.refreshed = {};
    entry.world = std::move(arrival.rerun).take();
    entry.replay = std::move(arrival.there);
    (void)entry.world.take_events(); // of the way there
    arrivals_.push_back(entry.name);
}

void TimeTravel::open(const OpenReplay& request, const PastReply& reply) {
    const auto origin = std::as_const(laboratory_).find(request.world);
    if (!origin) {
        return reply(laboratory_, origin.error());
    }
    std::size_t of_owner = 0, of_all = looks_.size();
    for (const auto& [name, look] : looks_) {
        of_owner += look.owner == request.owner;
    }
    for (const auto& [owner, count] : opening_) {
        of_owner += owner == request.owner ? count : 0;
        of_all += count;
    }
    if (of_owner >= replays_max || of_all >= pasts_of_all_max) {
        return reply(laboratory_, refusal(RefusalCode::ResourceExhausted,
                                          of_owner >= replays_max
                                              ? "this session looks at " + std::to_string(replays_max) +
                                                    " pasts already: close one first"
                                              : "all clients together look at " + std::to_string(pasts_of_all_max) +
                                                    " pasts already: try again when one of them is closed",
                                          base::Reason::PastsMax));
    }
    const std::string name = (*origin)->is_look_back() ? (*origin)->replay->replay_of : (*origin)->name;
    const std::string world = (*origin)->name;
    const auto past = replay_of(world);
    if (!past) {
        return reply(laboratory_, past.error());
    }
    ++opening_[request.owner];
    const auto opened = [this, owner = request.owner, reply](const Result<std::string>& look) {
        if (const auto opening = opening_.find(owner); opening != opening_.end() && --opening->second == 0) {
            opening_.erase(opening);
        }
        reply(laboratory_, look);
    };
    const auto known = known_of(world, past->run_id());
    once_written(world, [this, name, known, past = *past, request, opened](bool all_is_written) {
        std::optional<replay::WantedMoment> at;
        if (request.at.generation || request.at.tick) {
            at = request.at;
        }
        const auto arrived = [this, name, past, owner = request.owner, opened](Result<Arrival> arrival) {
            if (!arrival) {
                return opened(within(arrival.error(), "at"));
            }
            arrival->there.replay_of = name;
            const std::string look_name = name + "@" + std::to_string(++last_look_);
            show(look_name, past, owner, *std::move(arrival));
            opened(look_name);
        };
        if (!opening_.contains(request.owner)) {
            return opened(owner_gone());
        }
        set_out(past, at, all_is_written ? known : replay::KnownUntil{}, request.owner, arrived);
    });
}

void TimeTravel::seek(const Seek& request, const PastReply& reply) {
    const auto entry = std::as_const(laboratory_).find(request.world);
    if (!entry) {
        return reply(laboratory_, entry.error());
    }
    const std::string name = (*entry)->name;
    if (!looks_.contains(name)) {
        return reply(
            laboratory_,
            Refusal{.code = RefusalCode::FailedPrecondition,
                    .message =
                        "this world lives and cannot be taken to another moment: open its "
                        "past, as evoview and evoctl stats --at-generation do, or serve its file with evod replay",
                    .violations = {},
                    .reason = base::Reason::WorldIsLive});
    }
    const std::string& replay_of = (*entry)->replay->replay_of;
    const std::string origin = replay_of.empty() ? name : replay_of;
    const auto known_now = known_of(origin, looks_.find(name)->second.past.run_id());
    ++seeking_[request.owner];
    const auto sought = [this, owner = request.owner, reply](const Result<std::string>& world) {
        if (const auto seeking = seeking_.find(owner); seeking != seeking_.end() && --seeking->second == 0) {
            seeking_.erase(seeking);
        }
        reply(laboratory_, world);
    };
    once_written(origin, [this, name, known_now, request, sought](bool all_is_written) {
        const auto look = looks_.find(name);
        if (look == looks_.end()) {
            return sought(closed_since());
        }
        if (!seeking_.contains(request.owner)) {
            return sought(owner_gone());
        }
        const replay::Past& past = look->second.past;
        // The world may have begun another run: what is looked at is still the one of the look.
        const simulation::Replay& seen = *entry_of(name)->replay;
        replay::KnownUntil known{.generation = seen.last_generation, .tick = seen.last_tick};
        if (all_is_written) {
            known.generation = std::max(known.generation, known_now.generation);
            known.tick = std::max(known.tick, known_now.tick);
        }
        const auto arrived = [this, name, replay_of = seen.replay_of, sought](Result<Arrival> arrival) {
            if (!arrival) {
                return sought(within(arrival.error(), "to"));
            }
            const auto seen_from = looks_.find(name);
            if (seen_from == looks_.end()) {
                return sought(closed_since());
            }
            arrival->there.replay_of = replay_of;
            arrive_in(*entry_of(name), seen_from->second, *std::move(arrival));
            sought(name);
        };
        set_out(past, request.to, known, request.owner, arrived, [this, name](std::uint64_t journey) {
            const auto look_on = looks_.find(name);
            if (look_on == looks_.end()) {
                return false;
            }
            give_up(std::exchange(look_on->second.journey, journey), superseded());
            return true;
        });
    });
}

Result<std::string> TimeTravel::close(const CloseReplay& request) {
    const auto look = looks_.find(request.world);
    if (look == looks_.end() || look->second.owner == 0) {
        return Refusal{.code = RefusalCode::NotFound,
                       .message = "there is no such look at the past",
                       .violations = {{"world", "one that was opened with OpenReplay", request.world}},
                       .reason = base::Reason::WorldNotFound};
    }
    give_up(look->second.journey, closed_since());
    laboratory_.dismiss(request.world);
    looks_.erase(look);
    return request.world;
}

void TimeTravel::close_all_of(std::uint64_t owner) {
    std::erase_if(looks_, [&](const auto& item) {
        if (item.second.owner != owner) {
            return false;
        }
        laboratory_.dismiss(item.first);
        return true;
    });
    opening_.erase(owner);
    seeking_.erase(owner);
    std::vector<Arrived> given_up;
    std::erase_if(departing_, [&](auto& item) {
        if (item.second.owner != owner) {
            return false;
        }
        given_up.push_back(std::move(item.second.arrived));
        return true;
    });
    std::erase_if(journeys_, [&](Journey& journey) {
        if (journey.owner != owner) {
            return false;
        }
        given_up.push_back(std::move(journey.arrived));
        return true;
    });
    for (const Arrived& arrived : given_up) {
        arrived(owner_gone());
    }
}

void TimeTravel::follow(simulation::Entry& entry) {
    if (const auto look = looks_.find(entry.name); look != looks_.end()) {
        look->second.changes.make_due(entry.world);
    }
}

std::optional<Clock::time_point> TimeTravel::refresh(Clock::time_point now) {
    std::optional<Clock::time_point> next;
    for (auto& [name, look] : looks_) {
        simulation::Entry& entry = *entry_of(name);
        const bool at_its_end = entry.world.moment().tick >= entry.replay->last_tick;
        if (!at_its_end || (entry.control.paused && !entry.control.until_tick) || look.being_read) {
            continue;
        }
        if (now >= look.refreshed + refresh_time) {
            look.refreshed = now;
            ask_for_news(name, look);
        }
        const auto again = look.refreshed + refresh_time;
        next = next ? std::min(*next, again) : again;
    }
    return next;
}

void TimeTravel::ask_for_news(const std::string& name, Look& look) {
    look.being_read = true;
    reader_.ask([this, name, past = look.past, after = look.entries_read]() -> PastReader::Then {
        return [this, name, news = base::within_memory([&] { return past.news(after); })] {
            const auto look_on = looks_.find(name);
            if (look_on == looks_.end()) {
                return;
            }
            look_on->second.being_read = false;
            if (news) {
                go_on(*entry_of(name), look_on->second, *news);
            }
        };
    });
}

void TimeTravel::go_on(simulation::Entry& entry, Look& look, const replay::PastNews& news) {
    // Asked for before the look was taken to another moment, the news may begin after what is known there.
    if (news.there.last_tick <= entry.replay->last_tick || news.after_entry > look.entries_read) {
        return;
    }
    // Commands may have come since the last time.
    if (!look.changes.extend(news.path, news.changes)) {
        return;
    }
    look.entries_read = std::max(look.entries_read, news.last_entry);
    look.changes.make_due(entry.world);
    const std::string replay_of = entry.replay->replay_of;
    entry.replay = news.there;
    entry.replay->replay_of = replay_of;
}

} // namespace evod::runtime
