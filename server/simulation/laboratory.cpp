#include "server/simulation/laboratory.h"

#include "proto/text/suggestion.h"
#include "server/base/inline_executor.h"
#include "server/simulation/entities.h"
#include "server/simulation/rating.h"
#include "server/simulation/world_name.h"

#include <algorithm>
#include <functional>
#include <type_traits>
#include <utility>

namespace evod::simulation {
namespace {

using base::Refusal;
using base::RefusalCode;
using base::Result;

/// Returns how many generations of the run have ended.
std::uint64_t generations_over(const World& world) {
    return world.moment().generation - (world.generation_over() ? 0 : 1);
}

const char* criterion(evolution::Outcome outcome) {
    switch (outcome) {
    case evolution::Outcome::Running:
        return "none";
    case evolution::Outcome::TargetFitness:
        return "target_fitness";
    case evolution::Outcome::Extinction:
        return "stop_at_extinction";
    case evolution::Outcome::Stagnation:
        return "stagnation_limit";
    case evolution::Outcome::GenerationLimit:
        return "generation_limit";
    }
    return "none";
}

std::optional<Refusal> refusal_if_terminated(const World& world) {
    const evolution::Outcome outcome = world.outcome();
    if (outcome == evolution::Outcome::Running) {
        return std::nullopt;
    }
    return refusal(RefusalCode::FailedPrecondition,
                   std::string{"the run has ended because of "} + criterion(outcome) +
                       ": change this parameter to continue the run, or reset the world",
                   base::Reason::RunEnded);
}

/// A replay shows a stored run, so commands that would change the run are refused.
template <class C>
std::optional<Refusal> refusal_if_replay(const Entry& entry, const C&) {
    constexpr bool changes_what_happens = std::is_same_v<C, DeleteWorld> || std::is_same_v<C, ResetWorld> ||
                                          std::is_same_v<C, SetParameters> || std::is_same_v<C, CancelChange> ||
                                          std::is_same_v<C, PlaceEntities> || std::is_same_v<C, RemoveEntities> ||
                                          std::is_same_v<C, SetFitness>;
    if (!changes_what_happens || !entry.replay) {
        return std::nullopt;
    }
    return refusal(RefusalCode::FailedPrecondition, "this world is a replay, which cannot be changed: fork it",
                   base::Reason::WorldIsReplay);
}

std::string ids_of(const std::vector<parameters::PlannedChange>& planned) {
    std::string ids;
    for (const parameters::PlannedChange& change : planned) {
        ids += (ids.empty() ? "" : ", ") + std::to_string(change.id);
    }
    return ids.empty() ? "none: nothing is planned" : ids;
}

/// Returns why the change cannot be planned; nullopt if it can.
std::optional<Refusal> refusal_of_plan(const World& world, const SetParameters& command) {
    std::vector<base::Violation> violations;
    const parameters::PlannedMoment& at = *command.at;
    const Moment& now = world.moment();
    if (!world.is_in_future(at)) {
        violations.push_back({at.generation ? "set_parameters.at_generation" : "set_parameters.at_tick",
                              "at least " + std::to_string(1 + (at.generation ? now.generation : now.tick)),
                              std::to_string(at.generation ? *at.generation : *at.tick)});
    }
    for (const parameters::Assignment& assignment : command.assignments) {
        if (const auto* description = parameters::find_parameter(assignment.name);
            description != nullptr && !parameters::can_be_scheduled(*description)) {
            violations.push_back({"set_parameters." + assignment.name,
                                  "only without at_tick and at_generation: it takes effect at a reset",
                                  parameters::to_text(assignment.value)});
        }
    }
    if (!violations.empty()) {
        return Refusal{.code = RefusalCode::InvalidArgument,
                       .message = "invalid planned change",
                       .violations = std::move(violations)};
    }
    if (world.planned().size() >= parameters::planned_changes_max) {
        return base::limit_refusal("there are " + std::to_string(parameters::planned_changes_max) +
                                       " planned changes already: cancel one first",
                                   base::Reason::PlannedChangesMax, "planned_changes_max", world.planned().size(),
                                   parameters::planned_changes_max);
    }
    return std::nullopt;
}

Applied applied_now(const Entry& entry) {
    return {.world = entry.name, .tick = entry.world.moment().tick, .parameters = {}};
}

bool has_goal(const RunControl& control) {
    return control.endless || control.until_generation;
}

/// Resumes the run toward its goal, if it has one.
void resume_run(RunControl& control) {
    control.paused = control.leased = false;
    control.until_tick.reset();
}

} // namespace

std::uint64_t genes_of(const parameters::Parameters& p) {
    return std::uint64_t{p.island_count} * p.population_size * evolution::gene_count(p);
}

bool remove_reached_goals(RunControl& control, const World& world) {
    bool reached = false;
    if (control.until_tick && world.moment().tick >= *control.until_tick) {
        control.until_tick.reset();
        control.paused = true;
        reached = true;
    }
    if (control.until_generation && generations_over(world) >= *control.until_generation) {
        control.until_generation.reset();
        reached = true;
    }
    return reached;
}

bool Entry::wants_tick() const {
    return !frozen && !world.awaits_fitness() && wants_to_run();
}

bool Entry::wants_to_run() const {
    if (world.outcome() != evolution::Outcome::Running || (replay && world.moment().tick >= replay->last_tick)) {
        return false;
    }
    if (control.until_tick) {
        return world.moment().tick < *control.until_tick;
    }
    return !control.paused &&
           (control.endless || (control.until_generation && generations_over(world) < *control.until_generation));
}

RunState Entry::state() const {
    if (world.outcome() != evolution::Outcome::Running) {
        return RunState::Terminated;
    }
    if (wants_to_run()) {
        return RunState::Running;
    }
    return control.paused ? RunState::Paused : RunState::Waiting;
}

void Laboratory::advance(Entry& entry, std::uint64_t ticks, base::Executor& executor) {
    const World& world = entry.world;
    const std::uint64_t now = world.moment().tick;
    std::uint64_t last = now + (world.generation_over() ? 1 : ticks);
    if (entry.control.until_tick) {
        last = std::min(last, *entry.control.until_tick);
    }
    for (const parameters::PlannedChange& change : world.planned()) {
        last = std::min(last, change.at.tick.value_or(last));
    }
    entry.world.advance(last, executor);
    settle(entry);
}

void Laboratory::settle(Entry& entry) {
    for (EventKind& kind : entry.world.take_events()) {
        const auto* extinction = std::get_if<Extinction>(&kind);
        const std::uint64_t tick = extinction != nullptr ? extinction->tick : entry.world.moment().tick;
        events_.push_back({entry.name, entry.run_id, tick, std::move(kind)});
    }
    if (remove_reached_goals(entry.control, entry.world)) {
        events_.push_back({entry.name, entry.run_id, entry.world.moment().tick, GoalReached{}});
    }
}

base::Refusal DamagedWorld::refusal() const {
    return base::refusal(RefusalCode::FailedPrecondition, "the world does not run: " + reason,
                         base::Reason::WorldDamaged);
}

base::Refusal no_such_replay(std::string_view name) {
    return {.code = RefusalCode::NotFound,
            .message = "there is no such replay",
            .violations = {{"world", "one that was opened with OpenReplay", std::string{name}}},
            .reason = base::Reason::WorldNotFound,
            .arguments = {{"world", std::string{name}}}};
}

namespace {

bool is_world(const std::unique_ptr<Entry>& entry) {
    return !entry->replays_another_world();
}

} // namespace

std::size_t Laboratory::world_count() const {
    return static_cast<std::size_t>(std::ranges::count_if(entries_, is_world)) + damaged_.size();
}

std::string_view Laboratory::meant_by(std::string_view name) const {
    if (!name.empty()) {
        return name;
    }
    if (world_count() != 1) {
        return "default";
    }
    return damaged_.empty() ? (*std::ranges::find_if(entries_, is_world))->name : damaged_.front().name;
}

const DamagedWorld* Laboratory::find_damaged(std::string_view name) const {
    const auto found = std::ranges::find(damaged_, meant_by(name), &DamagedWorld::name);
    return found == damaged_.end() ? nullptr : &*found;
}

Result<Entry*> Laboratory::find(std::string_view name) {
    const std::string_view meant = meant_by(name);
    const auto found = std::ranges::find_if(entries_, [&](const auto& entry) { return entry->name == meant; });
    if (found != entries_.end()) {
        return found->get();
    }
    if (const DamagedWorld* damaged = find_damaged(meant)) {
        return damaged->refusal();
    }
    return not_found(name);
}

Refusal Laboratory::not_found(std::string_view name) const {
    if (is_replay_name(name)) {
        return no_such_replay(name);
    }
    std::vector<std::string_view> names;
    for (const auto& entry : entries_) {
        if (is_world(entry)) {
            names.push_back(entry->name);
        }
    }
    for (const DamagedWorld& world : damaged_) {
        names.push_back(world.name);
    }
    if (names.empty()) {
        return refusal(RefusalCode::NotFound, "there is no world: create one", base::Reason::WorldNotFound);
    }
    std::string list;
    for (const std::string_view one : names) {
        list += (list.empty() ? "" : ", ") + std::string{one};
    }
    if (name.empty()) {
        return refusal(RefusalCode::NotFound, "the request names no world: name one of " + list,
                       base::Reason::WorldNotFound);
    }
    Refusal refused{.code = RefusalCode::NotFound,
                    .message = "no world has that name",
                    .violations = {{"world", list, std::string{name}}},
                    .reason = base::Reason::WorldNotFound,
                    .arguments = {{"world", std::string{name}}}};
    if (const auto similar = text::nearest(name, names); !similar.empty()) {
        refused.message += text::did_you_mean(name, names);
        refused.arguments.push_back({"suggestion", similar.front()});
    }
    return refused;
}

Result<const Entry*> Laboratory::find(std::string_view name) const {
    const Result<Entry*> found = const_cast<Laboratory*>(this)->find(name);
    if (!found) {
        return found.error();
    }
    return *found;
}

Result<Applied> Laboratory::apply(const Command& command) {
    return std::visit(
        [this](const auto& c) -> Result<Applied> {
            if constexpr (requires { carry_out(c); }) {
                return carry_out(c);
            } else {
                const Result<Entry*> found = find(c.world);
                if (!found) {
                    return found.error();
                }
                if (auto refused = refusal_if_replay(**found, c)) {
                    return *refused;
                }
                return carry_out(**found, c);
            }
        },
        command);
}

std::optional<Refusal> Laboratory::refusal_of(const std::string& name) const {
    if (find_damaged(name) != nullptr ||
        std::ranges::any_of(entries_, [&](const auto& entry) { return entry->name == name; })) {
        return Refusal{.code = RefusalCode::AlreadyExists,
                       .message = "a world with that name already exists",
                       .violations = {{"name", "an unused name", name}},
                       .reason = base::Reason::WorldExists};
    }
    if (is_full()) {
        return base::limit_refusal("there are " + std::to_string(worlds_max_) + " worlds already: delete one first",
                                   base::Reason::WorldsMax, "worlds_max", worlds_max_, worlds_max_);
    }
    return std::nullopt;
}

bool Laboratory::is_full() const {
    return world_count() >= worlds_max_;
}

template <class C>
Result<Applied> Laboratory::construct_and_adopt(const C& command) {
    const Result<Construction> construction = this->construction(command);
    if (!construction) {
        return construction.error();
    }
    base::InlineExecutor executor; // a command is applied between two ticks, where no executor is available
    return adopt(command, construction->construct(executor));
}

Result<Construction> Laboratory::construction(const CreateWorld& command) const {
    if (auto refused = refusal_of(command.name)) {
        return *refused;
    }
    return Construction{
        .construct =
            [command, maker = maker_](base::Executor&) {
                return World{command.parameters, command.seed, command.first_population, command.schedule, maker};
            },
        .genes = genes_of(command.parameters),
        .is_shared = maker_ != nullptr};
}

Result<Applied> Laboratory::adopt(const CreateWorld& command, World world) {
    return add(command.name, command.run_id, std::move(world), command.ownership);
}

Result<Applied> Laboratory::carry_out(const DeleteWorld& command) {
    if (std::erase_if(damaged_, [&](const DamagedWorld& world) { return world.name == command.world; }) > 0) {
        return Applied{.world = command.world, .parameters = {}};
    }
    const auto found =
        std::find_if(entries_.begin(), entries_.end(), [&](const auto& entry) { return entry->name == command.world; });
    if (found == entries_.end()) {
        return not_found(command.world);
    }
    if (auto refused = refusal_if_replay(**found, command)) {
        return *refused;
    }
    const Applied applied{.world = command.world, .tick = (*found)->world.moment().tick, .parameters = {}};
    entries_.erase(found);
    return applied;
}

Result<Construction> Laboratory::construction(const ResetWorld& command) const {
    const Result<const Entry*> found = find(command.world);
    if (!found) {
        return found.error();
    }
    if (auto refused = refusal_if_replay(**found, command)) {
        return *refused;
    }
    const World& world = (*found)->world;
    const Result<parameters::Parameters> beginning = world.beginning(command.listed_genes);
    if (!beginning) {
        return Refusal{
            .code = RefusalCode::FailedPrecondition,
            .message = "cannot reset the world: the requested parameters do not fit the scheduled values of generation "
                       "1; change the parameters that are not scheduled, or create another world",
            .violations = beginning.error().violations,
            .reason = base::Reason::ResetImpossible};
    }
    if (auto faults = faults_of(world.first_population(), *beginning, "population"); !faults.empty()) {
        return Refusal{
            .code = RefusalCode::FailedPrecondition,
            .message = "cannot reset the world: the requested parameters do not fit the first population that it was "
                       "created with; change them back, or create another world",
            .violations = std::move(faults),
            .reason = base::Reason::ResetImpossible};
    }
    return Construction{
        .construct = [&world, seed = command.seed.value_or(world.seed()), listed_genes = command.listed_genes,
                      maker = maker_](base::Executor&) { return world.restarted(seed, listed_genes, maker); },
        .genes = genes_of(*beginning),
        .reads_world = true,
        .is_shared = maker_ != nullptr};
}

Result<Applied> Laboratory::adopt(const ResetWorld& command, World world) {
    const Result<Entry*> found = find(command.world);
    if (!found) {
        return found.error();
    }
    Entry& entry = **found;
    entry.world = std::move(world);
    entry.run_id = command.run_id;
    const Speed speed = entry.control.speed;
    entry.control = {};
    entry.control.speed = speed;
    return applied_now(entry);
}

Result<Applied> Laboratory::carry_out(Entry& entry, const Run& command) {
    if (auto refused = refusal_if_terminated(entry.world)) {
        return *refused;
    }
    entry.control.endless = !command.generations;
    entry.control.until_generation.reset();
    if (command.generations) {
        const std::uint64_t over = generations_over(entry.world);
        // A sum beyond the range of the counter becomes its maximum, which no run reaches.
        entry.control.until_generation = over + std::min(*command.generations, ~std::uint64_t{0} - over);
    }
    resume_run(entry.control);
    return applied_now(entry);
}

Result<Applied> Laboratory::carry_out(Entry& entry, const RunUntilTick& command) {
    const std::uint64_t now = entry.world.moment().tick;
    if (command.tick > now) {
        if (auto refused = refusal_if_terminated(entry.world)) {
            return *refused;
        }
    }
    // A replay needs no lease, because a replay belongs to the client that opened it.
    entry.control.leased |= has_goal(entry.control) && !entry.control.paused && !entry.replay;
    if (entry.control.leased) {
        entry.control.lease = ++leases_granted_;
    }
    entry.control.paused = true;
    entry.control.until_tick.reset();
    if (command.tick > now) {
        entry.control.until_tick = command.tick;
    }
    return applied_now(entry);
}

Result<Applied> Laboratory::carry_out(Entry& entry, const ReleaseLease& command) {
    if (command.lease && *command.lease != entry.control.lease) {
        return refusal(RefusalCode::FailedPrecondition, "the lease is outdated: a later RunUntilTick has extended it",
                       base::Reason::NoLease);
    }
    if (entry.control.leased) {
        resume_run(entry.control);
    }
    return applied_now(entry);
}

Result<Applied> Laboratory::carry_out(Entry& entry, const Pause&) {
    entry.control.paused = true;
    entry.control.leased = false;
    entry.control.until_tick.reset();
    return applied_now(entry);
}

Result<Applied> Laboratory::carry_out(Entry& entry, const Resume&) {
    if (auto refused = refusal_if_terminated(entry.world)) {
        return *refused;
    }
    if (!has_goal(entry.control)) {
        return refusal(RefusalCode::FailedPrecondition,
                       "nothing to resume: the world has no goal; set one with start or run",
                       base::Reason::NothingToResume);
    }
    resume_run(entry.control);
    return applied_now(entry);
}

Result<Applied> Laboratory::carry_out(Entry& entry, const AddNote&) {
    return applied_now(entry); // the journal contains the note
}

Result<Applied> Laboratory::carry_out(Entry& entry, const SetSpeed& command) {
    entry.control.speed = command.speed;
    return applied_now(entry);
}

Result<Applied> Laboratory::carry_out(Entry& entry, const SetParameters& command) {
    World& world = entry.world;
    if (command.expected_revision && *command.expected_revision != world.parameters().revision) {
        return Refusal{.code = RefusalCode::Aborted,
                       .message = "the parameters have changed since you read them: read them again, and send "
                                  "the change with their new revision",
                       .violations = {{"set_parameters.expected_revision", std::to_string(world.parameters().revision),
                                       std::to_string(*command.expected_revision)}},
                       .reason = base::Reason::RevisionChanged,
                       .arguments = {{"expected_revision", std::to_string(*command.expected_revision)},
                                     {"revision", std::to_string(world.parameters().revision)}}};
    }
    if (command.at) {
        if (auto refused = refusal_of_plan(world, command)) {
            return *refused;
        }
    }
    const bool at_generation = command.at && command.at->generation;
    const Result<parameters::RequestedParameters> requested =
        (at_generation ? parameters::request_at_generation
                       : parameters::request_of)(world.parameters(), command.assignments, "set_parameters.");
    if (!requested) {
        return requested.error();
    }
    if (const ClassRules* rules = class_of(entry)) {
        if (auto outside = values_outside(*rules, entry.ownership.class_name, command.assignments, "set_parameters.");
            !outside.empty()) {
            return Refusal{.code = RefusalCode::InvalidArgument,
                           .message = "the ranges of the class are narrower",
                           .violations = std::move(outside)};
        }
    }
    if (command.at) {
        parameters::PlannedChange change{
            .id = 0, .at = *command.at, .assignments = command.assignments, .by = command.by};
        if (!command.dry_run) {
            change.id = world.plan(change);
        }
        Applied planned = applied_now(entry);
        planned.planned = std::move(change);
        return planned;
    }
    Applied applied = applied_now(entry);
    applied.parameters = parameters::after_request(world.parameters(), *requested);
    if (!command.dry_run) {
        world.request_parameters(*requested, command.by);
    }
    return applied;
}

Result<Applied> Laboratory::carry_out(Entry& entry, const CancelChange& command) {
    const std::string there_are = ids_of(entry.world.planned());
    Applied applied = applied_now(entry);
    applied.planned = entry.world.cancel(command.id);
    if (!applied.planned) {
        return Refusal{.code = RefusalCode::NotFound,
                       .message =
                           "no planned change has that id: it was applied, dropped or cancelled, or never planned",
                       .violations = {{"cancel_change.id", there_are, std::to_string(command.id)}},
                       .reason = base::Reason::PlannedChangeNotFound};
    }
    return applied;
}

Result<Applied> Laboratory::carry_out(Entry& entry, const PlaceEntities& command) {
    if (auto checked = check(entry.world, command); !checked) {
        return checked.error();
    }
    Applied applied = applied_now(entry);
    applied.placed = entry.world.place(command);
    return applied;
}

Result<Applied> Laboratory::carry_out(Entry& entry, const RemoveEntities& command) {
    if (auto checked = check(entry.world, command); !checked) {
        return checked.error();
    }
    Applied applied = applied_now(entry);
    applied.removed = entry.world.remove(command);
    settle(entry);
    return applied;
}

Result<Applied> Laboratory::carry_out(Entry& entry, const SetFitness& command) {
    if (auto checked = check(entry.world, command); !checked) {
        return checked.error();
    }
    entry.world.set_fitness(command);
    settle(entry);
    return applied_now(entry);
}

Result<Applied> Laboratory::carry_out(const ForkWorld& command) {
    if (command.at_generation && find(command.world)) {
        return refusal(
            RefusalCode::FailedPrecondition,
            "cannot fork from the beginning of a generation: it is stored only in a run file, and there is none; "
            "fork the world as it is now, or start the server without --keep-nothing",
            base::Reason::RunsNotKept);
    }
    return construct_and_adopt(command);
}

Result<Construction> Laboratory::construction(const ForkWorld& command) const {
    const Result<const Entry*> found = find(command.world);
    if (!found) {
        return found.error();
    }
    if (auto refused = refusal_of(command.name)) {
        return *refused;
    }
    if (auto refused = refusal_of_fork(command)) {
        return *refused;
    }
    const World& world = (*found)->world;
    return Construction{
        .construct = [&world, maker = maker_](base::Executor& executor) { return world.copy(executor, maker); },
        .genes = genes_of(world.parameters().active),
        .reads_world = true,
        .is_shared = world.is_shared() || maker_ != nullptr};
}

Result<Applied> Laboratory::adopt(const ForkWorld& command, World world) {
    base::InlineExecutor executor;
    share(world, executor);
    (void)world.take_events(); // the events of the original have already been reported
    world.become_fork();
    if (auto refused = refusal_of_fork(command)) {
        return *refused;
    }
    return add(command.name, command.run_id, std::move(world), command.ownership);
}

Result<Applied> Laboratory::add(const std::string& name, const RunId& run_id, World world, Ownership ownership) {
    if (auto refused = refusal_of(name)) {
        return *refused;
    }
    auto entry = std::make_unique<Entry>(Entry{name, run_id, RunControl{}, std::move(world)});
    entry->storage = storage_;
    entry->ownership = std::move(ownership);
    const ClassRules* rules = class_of(*entry);
    entry->frozen = rules != nullptr && rules->frozen;
    Applied applied = applied_now(*entry);
    entries_.push_back(std::move(entry)); // last, so that nothing needs to be undone if memory does not suffice
    return applied;
}

void Laboratory::share(IslandsMaker& maker, base::Executor& executor) {
    maker_ = &maker;
    for (const auto& entry : entries_) {
        if (!entry->replay) {
            share(entry->world, executor);
        }
    }
}

void Laboratory::share(World& world, base::Executor& executor) const {
    if (maker_ != nullptr && !world.is_shared() && maker_->divides(world.island_count())) {
        world = world.copy(executor, maker_);
    }
}

void Laboratory::set_storage(const Storage& storage) {
    storage_ = storage;
    for (const auto& entry : entries_) {
        if (!entry->replay) {
            entry->storage = storage;
        }
    }
}

} // namespace evod::simulation
