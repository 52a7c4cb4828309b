#include "server/runtime/seeks.h"

#include "server/base/inline_executor.h"
#include "server/base/within_memory.h"

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
        seek.from.turn_over(executor);
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

void Seeks::begin(const std::string& world, Request request) {
    const std::uint64_t number = ++last_number_;
    seeks_.emplace(number, Begun{.request = std::move(request)});
    reader_.once_written(world, [this, number](bool all_is_written) { read(number, all_is_written); });
}

void Seeks::read(std::uint64_t number, bool all_is_written) {
    const auto found = seeks_.find(number);
    if (found == seeks_.end()) {
        return; // it was cancelled
    }
    if (std::ranges::count_if(seeks_, [](const auto& item) { return item.second.started; }) >=
        static_cast<std::ptrdiff_t>(seeks_max)) {
        return refuse(number, refusal(RefusalCode::ResourceExhausted, "too many seeks are in progress: try again later",
                                      base::Reason::ReplaysMax));
    }
    found->second.started = true;
    const Request& request = found->second.request;
    replay::RecordedUntil known = request.shown;
    if (all_is_written) {
        known.generation = std::max(known.generation, request.known.generation);
        known.tick = std::max(known.tick, request.known.tick);
    }
    reader_.read([this, number, run = request.run, to = request.to, known]() -> std::function<void()> {
        base::InlineExecutor executor;
        const auto start = std::make_shared<base::Result<replay::SeekStart>>(
            base::within_memory([&] { return run.start_seek(to, known, executor); }));
        return [this, number, start] { this->run(number, std::move(*start)); };
    });
}

void Seeks::run(std::uint64_t number, base::Result<replay::SeekStart> start) {
    const auto found = seeks_.find(number);
    if (found == seeks_.end()) {
        return; // it was cancelled
    }
    if (!start) {
        return refuse(number, start.error());
    }
    if (const std::string& moved = found->second.request.moves; !moved.empty()) {
        cancel([&](const Begun& other) { return other.running && other.request.moves == moved; },
               refusal(RefusalCode::FailedPrecondition,
                       "superseded by a later seek: seek again if this moment is still wanted",
                       base::Reason::SeekSuperseded));
    }
    found->second.running = *std::move(start);
}

std::vector<Seeks::Begun> Seeks::take(const std::function<bool(const Begun&)>& is_wanted) {
    std::vector<Begun> taken;
    for (auto seek = seeks_.begin(); seek != seeks_.end();) {
        const auto here = seek++;
        if (is_wanted(here->second)) {
            taken.push_back(std::move(seeks_.extract(here).mapped()));
        }
    }
    return taken;
}

void Seeks::refuse(std::uint64_t number, const base::Refusal& why) {
    seeks_.extract(number).mapped().request.done(why);
}

void Seeks::cancel(const std::function<bool(const Begun&)>& is_wanted, const base::Refusal& why) {
    for (const Begun& seek : take(is_wanted)) {
        seek.request.done(why);
    }
}

void Seeks::cancel_of_session(std::uint64_t session) {
    cancel([&](const Begun& seek) { return seek.request.session == session; },
           refusal(RefusalCode::NotFound, "the session that sent the request has ended"));
}

void Seeks::cancel_of_replay(const std::string& replay) {
    cancel([&](const Begun& seek) { return seek.request.moves == replay; },
           refusal(RefusalCode::NotFound, "the replay has been closed: open it again", base::Reason::WorldNotFound));
}

std::size_t Seeks::opening_count(std::optional<std::uint64_t> session) const {
    return static_cast<std::size_t>(std::ranges::count_if(seeks_, [&](const auto& item) {
        const Request& request = item.second.request;
        return request.opens && (!session || request.session == *session);
    }));
}

bool Seeks::under_way() const {
    return std::ranges::any_of(seeks_, [](const auto& item) { return item.second.running.has_value(); });
}

void Seeks::advance(const std::function<bool()>& stop) {
    for (bool first = true; under_way();) {
        for (auto& [number, seek] : seeks_) {
            if (!seek.running) {
                continue;
            }
            if (!std::exchange(first, false) && stop()) {
                return;
            }
            if (advance_tick(*seek.running, executor_)) {
                seek.result = result_of(*std::exchange(seek.running, std::nullopt));
            }
        }
    }
}

void Seeks::finish() {
    for (Begun& seek : take([](const Begun& begun) { return begun.result.has_value(); })) {
        seek.request.done(*std::move(seek.result));
    }
}

} // namespace evod::runtime
