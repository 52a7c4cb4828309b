#include "server/simulation/run_parameters.h"

#include <algorithm>
#include <utility>

namespace evod::simulation {

bool is_after(const parameters::PlannedMoment& planned, const Moment& now) {
    return planned.generation ? *planned.generation > now.generation : *planned.tick > now.tick;
}

void RunParameters::become_fork() {
    planned_.clear();
    planned_count_ = 0;
    changes_.clear();
}

void RunParameters::request(const parameters::RequestedParameters& requested, std::uint64_t generation,
                            const base::Actor& by) {
    changes_.add(generation, by, set_.requested, requested);
    set_ = parameters::after_request(set_, requested);
}

parameters::Parameters RunParameters::active_in_next_tick(const Moment& now) const {
    return now.generation_tick == 0 ? parameters::taking_effect(set_.active, set_.requested, base::Effect::NextTick)
                                    : set_.active;
}

std::uint64_t RunParameters::plan(parameters::PlannedChange change) {
    change.id = ++planned_count_;
    planned_.push_back(std::move(change));
    return planned_count_;
}

std::optional<parameters::PlannedChange> RunParameters::cancel(std::uint64_t id) {
    const auto found = std::ranges::find(planned_, id, &parameters::PlannedChange::id);
    if (found == planned_.end()) {
        return std::nullopt;
    }
    parameters::PlannedChange cancelled = std::move(*found);
    planned_.erase(found);
    return cancelled;
}

void RunParameters::drop_due(const Moment& now) {
    std::erase_if(planned_, [&](const parameters::PlannedChange& change) { return !is_after(change.at, now); });
}

std::uint64_t RunParameters::next_stop(std::uint64_t tick) const {
    for (const parameters::PlannedChange& change : planned_) {
        tick = std::min(tick, change.at.tick.value_or(tick));
    }
    return tick;
}

void RunParameters::begin_breeding(std::uint64_t generation, std::vector<EventKind>& events) {
    if (const auto scheduled = schedule_.at(generation); !scheduled.empty()) {
        apply({.id = 0, .at = {}, .assignments = {scheduled.begin(), scheduled.end()}, .by = {}},
              parameters::request_at_generation(set_, scheduled), generation, events);
    }
    const auto is_due = [&](const parameters::PlannedChange& change) { return change.at.generation == generation; };
    for (const parameters::PlannedChange& change : planned_) {
        if (is_due(change)) {
            apply(change, parameters::request_at_generation(set_, change.assignments), generation, events);
        }
    }
    std::erase_if(planned_, is_due);
    set_.active = parameters::breeding_with(set_.active, set_.requested);
}

void RunParameters::apply_due(std::uint64_t tick, std::uint64_t generation, std::vector<EventKind>& events) {
    const auto is_due = [&](const parameters::PlannedChange& change) { return change.at.tick == tick; };
    for (const parameters::PlannedChange& change : planned_) {
        if (is_due(change)) {
            apply(change, parameters::request_of(set_, change.assignments), generation, events);
            begin_tick();
        }
    }
    std::erase_if(planned_, is_due);
}

void RunParameters::apply(const parameters::PlannedChange& change,
                          const base::Result<parameters::RequestedParameters>& requested, std::uint64_t generation,
                          std::vector<EventKind>& events) {
    std::vector<std::string> names;
    for (const parameters::Assignment& assignment : change.assignments) {
        names.push_back(assignment.name);
    }
    if (!requested) {
        events.push_back(ChangeDropped{.planned = change.id,
                                       .by = change.by,
                                       .names = std::move(names),
                                       .violations = requested.error().violations});
        return;
    }
    changes_.add(generation, change.by, set_.requested, *requested);
    set_.requested = *requested;
    ++set_.revision;
    events.push_back(
        ParametersChanged{.planned = change.id, .by = change.by, .names = std::move(names), .revision = set_.revision});
}

} // namespace evod::simulation
