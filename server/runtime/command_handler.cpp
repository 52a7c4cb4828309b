#include "server/runtime/command_handler.h"

#include "server/base/assert.h"
#include "server/base/overloaded.h"
#include "server/base/within_memory.h"
#include "server/protocol/answers.h"
#include "server/protocol/commands.h"
#include "server/protocol/events.h"
#include "server/protocol/for_each_world.h"
#include "server/protocol/request_rules.h"
#include "server/runtime/admission.h"
#include "server/runtime/fork.h"
#include "server/runtime/random_ids.h"
#include "server/simulation/world_name.h"

#include <algorithm>
#include <memory>
#include <type_traits>
#include <utility>

namespace evod::runtime {
namespace {

/// The effect of a command on the run of its world.
enum class RunEffect { Begins, BeginsAsFork, BeginsAgain, Ends, Continues };

RunEffect effect_of(const simulation::Command& command) {
    return std::visit(base::Overloaded{[](const simulation::CreateWorld&) { return RunEffect::Begins; },
                                       [](const simulation::ForkWorld&) { return RunEffect::BeginsAsFork; },
                                       [](const simulation::ResetWorld&) { return RunEffect::BeginsAgain; },
                                       [](const simulation::DeleteWorld&) { return RunEffect::Ends; },
                                       [](const auto&) { return RunEffect::Continues; }},
                      command);
}

bool changes_something(const simulation::Command& command) {
    const auto* set = std::get_if<simulation::SetParameters>(&command);
    return set == nullptr || !set->dry_run;
}

} // namespace

void CommandHandler::handle(CommandMail& mail) {
    if (waits_for_a_world(mail.command)) {
        return kept_.push_back(std::move(mail));
    }
    // From here on the command names its world explicitly, so that a rerun of the journal finds the same world.
    std::visit(
        [this](auto& command) {
            if constexpr (requires { command.world; }) {
                if (command.world.empty()) {
                    if (const auto entry = std::as_const(laboratory_).find("")) {
                        command.world = (*entry)->name;
                    } else if (const auto* damaged = laboratory_.find_damaged("")) {
                        command.world = damaged->name;
                    }
                }
            }
        },
        mail.command);
    const auto before = run_before(mail.command);
    if (auto refused = refusal_of_sender(mail)) {
        return answer(mail, *refused, before);
    }
    if (auto refused = refusal_of(mail.command)) {
        return answer(mail, *refused, before);
    }
    if (std::holds_alternative<simulation::ForkWorld>(mail.command)) {
        return fork(mail);
    }
    std::visit(
        [&]<class C>(const C& command) {
            if constexpr (requires { laboratory_.construction(command); }) {
                construct<C>(mail, before, laboratory_.construction(command));
            } else {
                answer(mail, apply(mail.command), before);
            }
        },
        mail.command);
}

std::optional<base::Refusal> CommandHandler::refusal_of_sender(CommandMail& mail) const {
    const simulation::Entry* world = entry_of_command(mail.command);
    const bool decides_without = std::visit(
        [this](const auto& command) {
            if constexpr (requires { command.world; }) {
                return laboratory_.find_damaged(command.world) != nullptr;
            }
            return true; // CreateWorld
        },
        mail.command);
    return world != nullptr || decides_without ? admit(mail, world) : std::nullopt;
}

void CommandHandler::handle(const ForEachWorld& mail) {
    std::vector<std::string> worlds;
    for (const auto& entry : laboratory_.entries()) {
        const bool is_fork = entry->name != simulation::first_world_of(entry->name, mail.class_name);
        if (entry->ownership.class_name == mail.class_name && (!is_fork || protocol::acts_on_forks(*mail.request))) {
            worlds.push_back(entry->name);
        }
    }
    outputs_.reply(BatchBegun{mail.batch, worlds});
    for (const std::string& world : worlds) {
        const v1::Request request = protocol::request_for(*mail.request, world);
        auto command = protocol::to_command(request, {draw_seed(), draw_run_id()});
        EVOD_ASSERT(command.has_value()); // the network thread has checked it
        if (auto* change = std::get_if<simulation::SetParameters>(&*command)) {
            change->by = mail.by;
        }
        CommandMail one{.command = *std::move(command),
                        .origin = {.by = mail.by,
                                   .client_key = protocol::key_for(request.client_key(), world),
                                   .request_id = request.request_id(),
                                   .request = request.SerializeAsString()},
                        .request_name = protocol::name_of(request),
                        .session = mail.session,
                        .user = mail.user,
                        .requester = mail.requester,
                        .rules = protocol::rules_of(request),
                        .batch = mail.batch};
        handle(one);
    }
}

void CommandHandler::handle(const SetClass& mail) {
    ClassSet done{mail.number};
    for (const auto& entry : laboratory_.entries()) {
        if (entry->ownership.class_name == mail.name) {
            done.worlds.push_back(entry->name);
        }
    }
    for (const std::string& world : laboratory_.set_class(mail.name, mail.rules)) {
        changed_.push_back(world);
        done.events.push_back(protocol::run_control_event(**laboratory_.find(world), mail.by));
    }
    outputs_.reply(std::move(done));
}

bool CommandHandler::waits_for_a_world(const simulation::Command& command) const {
    return std::visit(
        [this](const auto& c) {
            bool waits = false;
            if constexpr (requires { c.world; }) {
                waits |= builds_.holds(c.world) || is_announced_fork(c.world);
            }
            if constexpr (requires { c.name; }) {
                waits |= builds_.holds(c.name) || is_announced_fork(c.name);
            }
            return waits;
        },
        command);
}

bool CommandHandler::is_announced_fork(std::string_view world) const {
    return std::ranges::any_of(announced_forks_, [&](const ForkAnnounced& fork) {
        return world.empty() ? fork.comes_at_once : world == fork.name;
    });
}

void CommandHandler::handle_kept() {
    for (CommandMail& command : std::exchange(kept_, {})) {
        handle(command); // keeps it again if its world is still not free
    }
}

void CommandHandler::take(const WorldBuilt& built) {
    builds_.take(built);
    handle_kept();
}

const simulation::Entry* CommandHandler::entry_of_command(const simulation::Command& command) const {
    return std::visit(
        [this](const auto& c) -> const simulation::Entry* {
            if constexpr (requires { c.world; }) {
                if (const auto entry = laboratory_.find(c.world)) {
                    return *entry;
                }
            }
            return nullptr;
        },
        command);
}

std::optional<CommandHandler::RunBefore> CommandHandler::run_before(const simulation::Command& command) const {
    const simulation::Entry* entry = entry_of_command(command);
    return entry ? std::optional{RunBefore{entry->run_id, entry->world.moment().tick}} : std::nullopt;
}

std::optional<base::Refusal> CommandHandler::refusal_of(const simulation::Command& command) const {
    if (!recorder_ || !changes_something(command)) {
        return std::nullopt;
    }
    const simulation::Entry* entry = entry_of_command(command);
    if (auto refused = recorder_->refusal()) {
        return refused;
    }
    const auto* created = std::get_if<simulation::CreateWorld>(&command);
    const auto* forked = std::get_if<simulation::ForkWorld>(&command);
    if (auto refused = entry && !forked ? storage_.refusal_of(entry->name) : std::nullopt) {
        return refused;
    }
    const std::string* name = created ? &created->name : forked ? &forked->name : nullptr;
    // The laboratory refuses the name of a damaged world.
    return name && !laboratory_.find_damaged(*name) ? recorder_->refusal_of_place(*name) : std::nullopt;
}

base::Result<simulation::Applied> CommandHandler::apply(const simulation::Command& command) {
    if (const auto* deleted = std::get_if<simulation::DeleteWorld>(&command);
        deleted && recorder_ && laboratory_.find_damaged(deleted->world)) {
        if (auto moved = recorder_->move_aside(deleted->world); !moved) {
            return moved.error();
        }
    }
    return laboratory_.apply(command);
}

template <class C>
void CommandHandler::construct(CommandMail& mail, const std::optional<RunBefore>& before,
                               base::Result<simulation::Construction> construction) {
    if (!construction) {
        return answer(mail, construction.error(), before);
    }
    constexpr bool is_fork = std::is_same_v<C, simulation::ForkWorld>;
    const C command = std::get<C>(mail.command);
    WorldBuilds::Order order{.user = mail.user, .construction = *std::move(construction)};
    if (mail.session == 0) {
        order.at_once = true; // the first world of a server: every client must find it
    }
    if constexpr (std::is_same_v<C, simulation::ResetWorld>) {
        order.name = command.world;
    } else {
        order.name = command.name;
    }
    if constexpr (is_fork) {
        if (order.construction.reads_world) {
            order.original = command.world;
        }
    }
    simulation::Ownership ownership;
    if constexpr (std::is_same_v<C, simulation::ResetWorld>) {
        ownership = entry_of_command(mail.command)->ownership;
    } else {
        ownership = command.ownership;
    }
    order.finish = [name = order.name, command, is_recorded = recorder_ != nullptr, before,
                    ownership](simulation::World world, base::Executor& workers) {
        if constexpr (is_fork) {
            world = world_of_fork(command, std::move(world), workers);
        }
        BuiltWorld built{std::move(world), {}};
        if (is_recorded) {
            built.beginning =
                is_fork ? run_file::beginning_of_fork(built.world, name, command.run_id, before->run_id, workers)
                        : run_file::beginning_of_run(built.world, name, command.run_id);
            built.beginning->identity.ownership = ownership;
        }
        return built;
    };
    order.adopt = [this, waiting = std::make_shared<CommandMail>(std::move(mail)), command,
                   before](base::Result<BuiltWorld> built) {
        if (!built) {
            return answer(*waiting, built.error(), before);
        }
        const auto applied = base::within_memory([&] { return laboratory_.adopt(command, std::move(built->world)); });
        answer(*waiting, applied, before, std::move(built->beginning));
    };
    builds_.begin(std::move(order));
}

void CommandHandler::fork(CommandMail& mail) {
    const auto& command = std::get<simulation::ForkWorld>(mail.command);
    const simulation::Entry* original = entry_of_command(mail.command);
    const auto before = run_before(mail.command);
    if (original && begins_in_another_generation(command, original->world)) {
        if (const auto run = runs_.run_of(*original); !run) {
            return answer(mail, run.error(), before);
        }
        announced_forks_.push_back({command.name, false});
        const std::string world = original->name;
        return runs_.find({.world = world, .purpose = std::move(mail)});
    }
    construct<simulation::ForkWorld>(mail, before, laboratory_.construction(command));
}

void CommandHandler::take(ForkWorldComputed& computed) {
    const std::string& name = std::get<simulation::ForkWorld>(computed.fork.command).name;
    const auto announced = std::ranges::find(announced_forks_, name, &ForkAnnounced::name);
    EVOD_ASSERT(announced != announced_forks_.end());
    announced_forks_.erase(announced);
    adopt(computed);
    handle_kept();
}

void CommandHandler::adopt(ForkWorldComputed& computed) {
    const RunBefore before{computed.run_id, 0};
    if (!*computed.world) {
        return answer(computed.fork, computed.world->error(), before);
    }
    if (auto refused = refusal_of(computed.fork.command)) {
        return answer(computed.fork, *refused, before);
    }
    construct<simulation::ForkWorld>(
        computed.fork, before,
        simulation::Construction{.construct = [there = computed.world](base::Executor&) { return std::move(**there); },
                                 .genes = simulation::genes_of((*computed.world)->parameters().active)});
}

void CommandHandler::answer(CommandMail& mail, const base::Result<simulation::Applied>& applied,
                            const std::optional<RunBefore>& before, std::optional<run_file::RunBeginning> beginning) {
    outputs_.publish_events(laboratory_);
    if (applied) {
        changed_.push_back(applied->world);
    }
    CommandDone done = done_of(std::move(mail), applied);
    const bool deleted_damaged_world = applied && !before && effect_of(done.mail.command) == RunEffect::Ends;
    if (recorder_ && applied && changes_something(done.mail.command) && !deleted_damaged_world) {
        record(std::move(done), before, std::move(beginning));
    } else {
        outputs_.reply(std::move(done));
    }
}

CommandDone CommandHandler::done_of(CommandMail mail, const base::Result<simulation::Applied>& applied) const {
    CommandDone done{.mail = std::move(mail), .outcome = applied, .frame = {}};
    done.frame = protocol::frame_of(
        protocol::answer_of(done.mail.origin.request_id, done.mail.request_name, laboratory_, applied));
    if (!applied) {
        return done;
    }
    if (const auto entry = laboratory_.find(applied->world); entry && (*entry)->control.leased) {
        done.lease = (*entry)->control.lease;
    }
    if (tools_.demand.events_wanted()) {
        done.event = protocol::event_of(done.mail.command, *applied, done.mail.origin.by, laboratory_);
    }
    return done;
}

void CommandHandler::record(CommandDone done, const std::optional<RunBefore>& before,
                            std::optional<run_file::RunBeginning> beginning) {
    const simulation::Applied applied = *done.outcome;
    const RunEffect effect = effect_of(done.mail.command);
    const auto entry = std::as_const(laboratory_).find(applied.world);
    done.ticket = recorder_->next_ticket();
    recording::CommandRecord record{.tick = applied.tick,
                                    .control = effect == RunEffect::Ends ? simulation::RunControl{} : (*entry)->control,
                                    .origin = done.mail.origin,
                                    .answer = done.frame,
                                    .ticket = done.ticket};
    if (effect == RunEffect::BeginsAsFork) {
        const simulation::Entry& fork = **entry;
        done.fork = ForkFile{recorder_->paths_of(fork.name, fork.run_id), fork.run_id, fork.world.hash()};
    }
    outputs_.reply(std::move(done)); // before the record, so that its receipt comes later
    switch (effect) {
    case RunEffect::Begins:
    case RunEffect::BeginsAsFork:
        return recorder_->begin(*std::move(beginning), std::move(record));
    case RunEffect::BeginsAgain:
        return recorder_->begin_after_reset(*std::move(beginning), before->run_id, before->tick, std::move(record));
    case RunEffect::Ends:
        return recorder_->end(applied.world, before->run_id, std::move(record));
    case RunEffect::Continues:
        recorder_->of(applied.world)->journal(std::move(record));
        return recorder_->of(applied.world)->follow((*entry)->world); // fitness may have ended a generation
    }
}

} // namespace evod::runtime
