#include "server/network/first_world.h"

#include "server/log/log.h"
#include "server/protocol/parameters.h"
#include "server/protocol/populations.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace evod::network {

using Requested = FirstWorldOptions::Requested;

namespace {

/// Lists the parameters that differ: "population_size (50, not 60), selection (roulette, not tournament)".
std::string differences_of(const parameters::Parameters& there, const parameters::Parameters& wanted) {
    std::string text;
    for (const parameters::ParameterDescription* parameter : parameters::parameters_that_differ(there, wanted)) {
        text += (text.empty() ? "" : ", ") + std::string{parameter->name} + " (" +
                parameters::to_text(parameter->get(there)) + ", not " + parameters::to_text(parameter->get(wanted)) +
                ")";
    }
    return text;
}

bool creates_first_world(const FirstWorldOptions& first, const replay::Archive* archive) {
    if (archive == nullptr) {
        return true;
    }
    const std::vector<std::string> names = archive->world_names();
    return first.requested == Requested::Nothing ? names.empty() : !std::ranges::binary_search(names, first.world.name);
}

} // namespace

base::Result<FirstWorld> FirstWorld::choose(const LiveWorlds& options, const replay::Archive* archive) {
    FirstWorld first{options, archive};
    if (archive == nullptr) {
        return first;
    }
    if (auto same = first.compare_with_stored(*archive); !same) {
        return same.error();
    }
    if (auto found = first.find_begun(*archive); !found) {
        return found.error();
    }
    return first;
}

FirstWorld::FirstWorld(const LiveWorlds& options, const replay::Archive* archive)
    : options_{&options}
    , is_created_{creates_first_world(options.first_world, archive)}
    , begun_{options.first_world.world.name} {
    if (is_created_) {
        seed_ = options.first_world.world.seed;
    } else if (const run_file::RunIdentity* there = archive->identity_of(begun_)) {
        seed_ = there->seed;
    }
}

base::Result<void> FirstWorld::compare_with_stored(const replay::Archive& archive) const {
    const Requested requested = options_->first_world.requested;
    const simulation::CreateWorld& wanted = options_->first_world.world;
    if (requested == Requested::Nothing) {
        return {};
    }
    if (archive.is_damaged(wanted.name)) {
        log::error({.world = wanted.name},
                   "--experiment, --seed and --population have no effect: world \"{}\" exists and is damaged",
                   wanted.name);
        return {};
    }
    const run_file::RunIdentity* there = archive.identity_of(wanted.name);
    if (there == nullptr) {
        return {};
    }
    const auto differs = [&](const std::string& in_what) {
        return refusal(base::RefusalCode::FailedPrecondition,
                       archive.path() + " contains a world \"" + wanted.name + "\" with other " + in_what +
                           ": use another --data folder, or start without --experiment, --seed "
                           "and --population, and reset or delete that world");
    };
    if (!(there->requested_parameters().values == wanted.parameters)) {
        return differs("parameters: " + differences_of(there->requested_parameters().values, wanted.parameters));
    }
    if (there->schedule != wanted.schedule) {
        return differs("schedule of parameters");
    }
    if (requested == Requested::WorldAndSeed && there->seed.value != wanted.seed.value) {
        return differs("seed (" + std::to_string(there->seed.value) + ", not " + std::to_string(wanted.seed.value) +
                       ")");
    }
    if (wanted.first_population && !simulation::same(there->first_population, wanted.first_population)) {
        return differs("organisms");
    }
    return {};
}

base::Result<void> FirstWorld::find_begun(const replay::Archive& archive) {
    if (is_created_ || options_->first_commands.is_empty()) {
        return {};
    }
    const std::vector<std::string> names = archive.world_names();
    if (options_->first_world.requested == Requested::Nothing && names.size() == 1) {
        begun_ = names.front();
    } else if (!std::ranges::binary_search(names, begun_)) {
        std::string all;
        for (const std::string& name : names) {
            all += (all.empty() ? "" : ", ") + name;
        }
        return refusal(base::RefusalCode::FailedPrecondition,
                       "--speed and --start apply to one world, but " + archive.path() + " contains the worlds " + all +
                           ": start without them, then use evoctl --world NAME speed and run");
    }
    begun_is_damaged_ = archive.is_damaged(begun_);
    other_count_ = names.size() - 1;
    return {};
}

v1::Request FirstWorld::creation() const {
    const simulation::CreateWorld& world = options_->first_world.world;
    v1::Request request;
    v1::CreateWorld& create = *request.mutable_create_world();
    create.set_name(world.name);
    create.set_seed(world.seed.value);
    for (const parameters::ParameterDescription* parameter : parameters::parameters_that_differ(world.parameters, {})) {
        v1::ParameterAssignment& assignment = *create.add_parameters();
        assignment.set_name(std::string{parameter->name});
        *assignment.mutable_value() = protocol::to_proto(parameter->get(world.parameters));
    }
    *create.mutable_schedule() = protocol::to_proto(world.schedule, 1);
    protocol::add_population(create, world.first_population);
    return request;
}

void FirstWorld::begin(const std::function<void(v1::Request)>& send) const {
    if (is_created_) {
        send(creation());
    }
    const FirstCommands& commands = options_->first_commands;
    if (commands.is_empty()) {
        return;
    }
    if (begun_is_damaged_) {
        log::warn({.world = begun_}, "--speed and --start have no effect: world \"{}\" is damaged", begun_);
        return;
    }
    if (other_count_ > 0) {
        log::info({.world = begun_}, "--speed and --start apply to world \"{}\" only; {} others continue as before",
                  begun_, other_count_);
    }
    if (commands.speed) {
        v1::Request request;
        request.mutable_set_speed()->set_world(begun_);
        if (*commands.speed) {
            request.mutable_set_speed()->mutable_speed()->set_real_time_factor(**commands.speed);
        } else {
            request.mutable_set_speed()->mutable_speed()->set_max(true);
        }
        send(std::move(request));
    }
    if (commands.run) {
        v1::Request request;
        request.mutable_run()->set_world(begun_);
        send(std::move(request));
    }
}

} // namespace evod::network
