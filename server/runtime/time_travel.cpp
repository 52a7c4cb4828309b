#include "server/runtime/time_travel.h"

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
    for (base::Violation& violation : refused.violations)
        violation.field = field + "." + violation.field;
    return refused;
}

} // namespace

Result<TimeTravel::Replay> TimeTravel::replay_of(const std::string& path, std::optional<std::uint64_t> generation,
                                                 base::Executor& executor) {
    auto past = storage::Past::of_file(path);
    if (!past)
        return past.error();
    const auto name = past->world_name();
    if (!name)
        return name.error();
    const auto recording = past->recording();
    if (!recording)
        return recording.error();
    const auto moment =
        past->find({.generation = generation.value_or(recording->first_generation), .tick = {}}, *recording);
    if (!moment)
        return moment.error();
    auto rerun = past->begin_before(*moment, executor);
    if (!rerun)
        return rerun.error();
    Journey journey{.number = 0, .rerun = *std::move(rerun), .to = *moment, .arrived = {}};
    while (!advance(journey, executor)) {
    }
    return Replay{*name, *std::move(past), std::move(journey.rerun), *recording};
}

void TimeTravel::show(Replay replay) {
    show(replay.name, std::move(replay.past), 0, std::move(replay.rerun), replay.recording);
}

void TimeTravel::show(const std::string& name, storage::Past past, std::uint64_t owner, storage::Rerun rerun,
                      const simulation::Recording& recording) {
    simulation::RunControl control;
    control.endless = control.paused = true;
    looks_.emplace(name, Look{past, rerun.changes(), owner, {}, 0});
    laboratory_.adopt(std::make_unique<simulation::Entry>(
        simulation::Entry{name, past.run_id(), control, std::move(rerun).take(), 0, false, recording}));
    (void)entry_of(name)->world.take_events(); // of the way there
}

simulation::Entry* TimeTravel::entry_of(const std::string& world) {
    const auto found = laboratory_.find(world);
    return found ? *found : nullptr;
}

void TimeTravel::apply(PastMail mail) {
    if (const auto* open_past = std::get_if<OpenPast>(&mail.request))
        return open(*open_past, mail.reply);
    if (const auto* seek_moment = std::get_if<Seek>(&mail.request))
        return seek(*seek_moment, mail.reply);
    if (const auto* close_past = std::get_if<ClosePast>(&mail.request))
        return mail.reply(laboratory_, close(*close_past));
    close_all_of(std::get<OwnerGone>(mail.request).owner);
}

void TimeTravel::find_run(const FindRun& mail) {
    const auto entry = std::as_const(laboratory_).find(mail.world);
    if (!entry)
        return mail.found(entry.error());
    look_at((*entry)->name, [found = mail.found, generation = (*entry)->world.moment().generation](
                                const Result<simulation::Recording>& there, const storage::Past& past) {
        found(there ? Result<FoundRun>{FoundRun{past, generation}} : there.error());
    });
}

Result<storage::Past> TimeTravel::past_of(const std::string& world) const {
    const auto entry = std::as_const(laboratory_).find(world);
    if (!entry)
        return entry.error();
    if (const auto look = looks_.find((*entry)->name); look != looks_.end())
        return look->second.past;
    if (!recorder_)
        return refusal(RefusalCode::FailedPrecondition,
                       "this server keeps no runs, so nothing tells of their past: start it without --keep-nothing");
    return storage::Past{recorder_->paths_of((*entry)->name, (*entry)->run_id), (*entry)->run_id};
}

void TimeTravel::look_at(const std::string& world, Seen then) {
    const auto past = past_of(world);
    if (!past)
        return then(past.error(), storage::Past{{}, {}});
    const auto see = [this, world, past = *past, then = std::move(then)](bool all_is_written) {
        auto recording = past.recording();
        const auto living = std::as_const(laboratory_).find(world);
        if (recording && all_is_written && living && !(*living)->recording && (*living)->run_id == past.run_id()) {
            const simulation::Moment& now = (*living)->world.moment();
            recording->last_generation = std::max(recording->last_generation, now.generation);
            recording->last_tick = std::max(recording->last_tick, now.tick);
        }
        then(std::move(recording), past);
    };
    storage::RunRecorder* recorder = recorder_ ? recorder_->of(world) : nullptr;
    if (!recorder || recorder_->refusal())
        return see(false); // what is in the file is what there is
    const std::uint64_t number = ++last_waiting_;
    waiting_.emplace(number, see);
    recorder->once_written([this, number] {
        mailbox_.push(QueryMail{[this, number](const simulation::Laboratory&) {
            if (auto waited = waiting_.extract(number))
                waited.mapped()(true);
        }});
    });
}

void TimeTravel::stop_waiting() {
    for (const auto& [number, see] : std::exchange(waiting_, {}))
        see(false);
}

std::uint64_t TimeTravel::set_out(const storage::Past& past, const storage::PastMoment& to, Arrived arrived) {
    if (journeys_.size() >= journeys_max) {
        arrived(refusal(RefusalCode::ResourceExhausted, "too many are on their way into the past: try again"));
        return 0;
    }
    auto rerun = past.begin_before(to, executor_);
    if (!rerun) {
        arrived(rerun.error());
        return 0;
    }
    journeys_.push_back({++last_journey_, *std::move(rerun), to, std::move(arrived)});
    return last_journey_;
}

void TimeTravel::begin_journey(const std::string& world, std::uint64_t generation, Arrived arrived) {
    look_at(world, [this, generation, arrived = std::move(arrived)](const Result<simulation::Recording>& there,
                                                                    const storage::Past& past) {
        if (!there)
            return arrived(there.error());
        const auto moment = past.find({.generation = generation, .tick = {}}, *there);
        if (!moment)
            return arrived(moment.error());
        set_out(past, *moment, arrived);
    });
}

bool TimeTravel::advance(Journey& journey, base::Executor& executor) {
    const simulation::World& world = journey.rerun.world();
    const simulation::Moment& now = world.moment();
    if (now.generation == journey.to.generation && now.tick >= journey.to.tick)
        return true;
    if (now.generation < journey.to.generation && world.generation_over())
        journey.rerun.turn_over(executor);
    else if (world.outcome() == evolution::Outcome::Running)
        journey.rerun.advance_tick(executor);
    else
        return true; // the run was over before: whoever arrives sees that
    return now.generation == journey.to.generation && now.tick >= journey.to.tick;
}

void TimeTravel::travel(const std::function<bool()>& stop) {
    for (std::size_t next = 0; !journeys_.empty() && !stop(); ++next) {
        const std::size_t i = next % journeys_.size();
        if (!advance(journeys_[i], executor_))
            continue;
        Journey journey = std::move(journeys_[i]);
        journeys_.erase(journeys_.begin() + static_cast<std::ptrdiff_t>(i));
        const simulation::Moment& there = journey.rerun.world().moment();
        if (there.generation == journey.to.generation && there.tick == journey.to.tick)
            journey.arrived(std::move(journey.rerun));
        else
            journey.arrived(refusal(RefusalCode::DataLoss,
                                    "simulated again, the run is over before the moment that its file tells of"));
    }
}

void TimeTravel::arrive_in(simulation::Entry& entry, Look& look, storage::Rerun rerun) {
    look.changes = rerun.changes();
    look.refreshed = {};
    entry.world = std::move(rerun).take();
    (void)entry.world.take_events(); // of the way there
    arrivals_.push_back(entry.name);
}

void TimeTravel::open(const OpenPast& request, const PastReply& reply) {
    const auto origin = std::as_const(laboratory_).find(request.world);
    if (!origin)
        return reply(laboratory_, origin.error());
    std::size_t of_owner = 0, of_all = looks_.size();
    for (const auto& [name, look] : looks_)
        of_owner += look.owner == request.owner;
    for (const auto& [owner, count] : opening_) {
        of_owner += owner == request.owner ? count : 0;
        of_all += count;
    }
    if (of_owner >= pasts_max || of_all >= pasts_of_all_max)
        return reply(laboratory_, refusal(RefusalCode::ResourceExhausted,
                                          of_owner >= pasts_max
                                              ? "this session looks at " + std::to_string(pasts_max) +
                                                    " pasts already: close one first"
                                              : "all clients together look at " + std::to_string(pasts_of_all_max) +
                                                    " pasts already: try again when one of them is closed"));
    const std::string name = (*origin)->is_look_back() ? (*origin)->recording->past_of : (*origin)->name;
    ++opening_[request.owner];
    const auto opened = [this, owner = request.owner, reply](const Result<std::string>& look) {
        if (const auto opening = opening_.find(owner); opening != opening_.end() && --opening->second == 0)
            opening_.erase(opening);
        reply(laboratory_, look);
    };
    look_at(
        (*origin)->name, [this, name, request, opened](Result<simulation::Recording> there, const storage::Past& past) {
            if (!there)
                return opened(there.error());
            there->past_of = name;
            storage::WantedMoment at = request.at;
            if (!at.generation && !at.tick)
                at.generation = there->first_generation;
            const auto moment = past.find(at, *there);
            if (!moment)
                return opened(within(moment.error(), "at"));
            set_out(past, *moment,
                    [this, name, past, there = *there, owner = request.owner, opened](Result<storage::Rerun> rerun) {
                        if (!rerun)
                            return opened(rerun.error());
                        if (!opening_.contains(owner))
                            return opened(refusal(RefusalCode::NotFound, "who asked for it is gone"));
                        const std::string look_name = name + "@" + std::to_string(++last_look_);
                        show(look_name, past, owner, *std::move(rerun), there);
                        opened(look_name);
                    });
        });
}

void TimeTravel::seek(const Seek& request, const PastReply& reply) {
    const auto entry = std::as_const(laboratory_).find(request.world);
    if (!entry)
        return reply(laboratory_, entry.error());
    const std::string name = (*entry)->name;
    if (!looks_.contains(name))
        return reply(laboratory_, Refusal{.code = RefusalCode::FailedPrecondition,
                                          .message = "this world lives and cannot be taken to another moment: open its "
                                                     "past, as evoview does, or serve its file with evod replay",
                                          .violations = {}});
    const std::string& past_of = (*entry)->recording->past_of;
    look_at(past_of.empty() ? name : past_of, [this, name, request, reply](Result<simulation::Recording> there,
                                                                           const storage::Past& past) {
        const auto look = looks_.find(name);
        if (look == looks_.end())
            return reply(laboratory_, refusal(RefusalCode::NotFound, "the past has been closed: open it again"));
        // The world may have begun another run: what is looked at is still the one of the look.
        if (!there || past.run_id() != look->second.past.run_id())
            there = look->second.past.recording();
        if (!there)
            return reply(laboratory_, there.error());
        simulation::Entry& shown = *entry_of(name);
        there->past_of = shown.recording->past_of;
        there->last_tick = std::max(there->last_tick, shown.recording->last_tick);
        there->last_generation = std::max(there->last_generation, shown.recording->last_generation);
        const auto moment = look->second.past.find(request.to, *there);
        if (!moment)
            return reply(laboratory_, within(moment.error(), "to"));
        // A journey that is still under way to another moment is in vain now.
        if (const auto old = std::ranges::find(journeys_, look->second.journey, &Journey::number);
            old != journeys_.end()) {
            const Arrived gave_up = std::move(old->arrived);
            journeys_.erase(old);
            gave_up(refusal(
                RefusalCode::FailedPrecondition,
                "another moment was asked for meanwhile, and that is shown: seek again if this one is still wanted"));
        }
        look->second.journey =
            set_out(look->second.past, *moment, [this, name, there = *there, reply](Result<storage::Rerun> rerun) {
                const auto seen_from = looks_.find(name);
                if (!rerun || seen_from == looks_.end())
                    return reply(laboratory_,
                                 rerun ? refusal(RefusalCode::NotFound, "the past has been closed: open it again")
                                       : rerun.error());
                simulation::Entry& arrived = *entry_of(name);
                arrived.recording = there;
                arrive_in(arrived, seen_from->second, *std::move(rerun));
                reply(laboratory_, name);
            });
    });
}

Result<std::string> TimeTravel::close(const ClosePast& request) {
    const auto look = looks_.find(request.world);
    if (look == looks_.end() || look->second.owner == 0)
        return Refusal{.code = RefusalCode::NotFound,
                       .message = "there is no such look at the past",
                       .violations = {{"world", "one that was opened with OpenPast", request.world}}};
    laboratory_.dismiss(request.world);
    looks_.erase(look);
    return request.world;
}

void TimeTravel::close_all_of(std::uint64_t owner) {
    std::erase_if(looks_, [&](const auto& item) {
        if (item.second.owner != owner)
            return false;
        laboratory_.dismiss(item.first);
        return true;
    });
    opening_.erase(owner);
}

void TimeTravel::follow(simulation::Entry& entry) {
    if (const auto look = looks_.find(entry.name); look != looks_.end())
        look->second.changes.make_due(entry.world);
}

std::optional<Clock::time_point> TimeTravel::refresh(Clock::time_point now) {
    std::optional<Clock::time_point> next;
    for (auto& [name, look] : looks_) {
        simulation::Entry& entry = *entry_of(name);
        const bool at_its_end = entry.world.moment().tick >= entry.recording->last_tick;
        if (!at_its_end || (entry.control.paused && !entry.control.until_tick))
            continue;
        if (now >= look.refreshed + refresh_time) {
            look.refreshed = now;
            go_on(entry, look);
        }
        const auto again = look.refreshed + refresh_time;
        next = next ? std::min(*next, again) : again;
    }
    return next;
}

void TimeTravel::go_on(simulation::Entry& entry, Look& look) {
    auto recording = look.past.recording();
    if (!recording || recording->last_tick <= entry.recording->last_tick)
        return;
    // Commands may have come since the last time.
    if (!look.past.extend(look.changes))
        return;
    look.changes.make_due(entry.world);
    recording->past_of = entry.recording->past_of;
    entry.recording = *std::move(recording);
}

} // namespace evod::runtime
