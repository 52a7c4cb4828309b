#include "server/protocol/commands.h"

#include "proto/text/number_text.h"
#include "server/protocol/entities.h"
#include "server/protocol/experiments.h"
#include "server/protocol/gene_list.h"
#include "server/protocol/parameters.h"
#include "server/protocol/populations.h"
#include "server/protocol/queries.h"
#include "server/protocol/ratings.h"
#include "server/protocol/refusals.h"
#include "server/simulation/founders.h"
#include "server/simulation/laboratory.h"
#include "server/simulation/world_name.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/unknown_field_set.h>

#include <cmath>
#include <utility>

namespace evod::protocol {
namespace {

using base::Violation;
using text::number_text;
using Violations = std::vector<Violation>;
using RequestCase = v1::Request::KindCase;

constexpr const char* least_1 = "at least 1";

/// Whether a request contains more assignments than parameters exist. It must then repeat a name, which is invalid.
/// Without this early check, a very long request could block the simulation.
bool has_too_many_assignments(int assignments, std::string field, Violations& violations) {
    const std::size_t most = parameters::parameter_registry().size();
    if (static_cast<std::size_t>(assignments) <= most) {
        return false;
    }
    violations.push_back(
        {std::move(field), "at most " + std::to_string(most) + " assignments", std::to_string(assignments)});
    return true;
}

/// Whether the founders that a request lacks are drawn. The network thread draws them, so there must not be many.
bool may_be_filled(const parameters::Parameters& parameters) {
    constexpr double genes_max = 1'000'000;
    return static_cast<double>(parameters.island_count) * parameters.population_size *
               evolution::gene_count(parameters) <=
           genes_max;
}

simulation::Command command_of(const v1::CreateWorld& request, const Draws& draws, Violations& violations) {
    if (!simulation::is_world_name(request.name())) {
        violations.push_back(
            {"create_world.name", std::string{simulation::world_name_allowed}, '"' + request.name() + '"'});
    }
    simulation::CreateWorld command{.name = request.name(),
                                    .parameters = {},
                                    .seed = request.has_seed() ? base::Seed{request.seed()} : draws.seed,
                                    .run_id = draws.run_id};
    if (!has_too_many_assignments(request.parameters_size(), "create_world.parameters", violations)) {
        Violations found;
        parameters::Experiment experiment = experiment_of(request, found);
        command.parameters = experiment.parameters;
        command.schedule = std::move(experiment.schedule);
        if (experiment.seed && !request.has_seed()) {
            command.seed = *experiment.seed;
        }
        if (found.empty()) {
            command.first_population = first_population_of(request, command.parameters, found);
            if (may_be_filled(command.parameters)) {
                command.first_population =
                    simulation::completed(command.first_population, command.parameters, command.seed);
            }
            const auto faults =
                simulation::faults_of(command.first_population, command.parameters, "create_world.population");
            found.insert(found.end(), faults.begin(), faults.end());
        }
        violations.insert(violations.end(), found.begin(), found.end());
    }
    return command;
}

/// Requires that a destructive command names its world, because an empty name may be a mistake of the client.
void require_world(const std::string& world, const char* field, Violations& violations) {
    if (world.empty()) {
        violations.push_back({field, "the name of a world", "nothing"});
    }
}

simulation::Command command_of(const v1::DeleteWorld& request, const Draws&, Violations& violations) {
    require_world(request.world(), "delete_world.world", violations);
    return simulation::DeleteWorld{lookup_name(request.world())};
}

simulation::Command command_of(const v1::ResetWorld& request, const Draws& draws, Violations& violations) {
    require_world(request.world(), "reset_world.world", violations);
    simulation::ResetWorld command{.world = lookup_name(request.world()), .seed = {}, .run_id = draws.run_id};
    if (request.has_seed()) {
        command.seed = base::Seed{request.seed()};
    }
    if (request.has_free_genes()) {
        command.listed_genes = to_gene_list(request.free_genes(), "reset_world.free_genes", violations);
    }
    return command;
}

simulation::Command command_of(const v1::Run& request, const Draws&, Violations& violations) {
    simulation::Run command{.world = lookup_name(request.world()), .generations = {}};
    if (request.has_generations()) {
        if (request.generations() == 0) {
            violations.push_back({"run.generations", least_1, "0"});
        }
        command.generations = request.generations();
    }
    return command;
}

simulation::Command command_of(const v1::ReleaseLease& request, const Draws&, Violations&) {
    return simulation::ReleaseLease{lookup_name(request.world())};
}

simulation::Command command_of(const v1::RunUntilTick& request, const Draws&, Violations&) {
    return simulation::RunUntilTick{.world = lookup_name(request.world()), .tick = request.tick()};
}

simulation::Command command_of(const v1::Pause& request, const Draws&, Violations&) {
    return simulation::Pause{lookup_name(request.world())};
}

simulation::Command command_of(const v1::Resume& request, const Draws&, Violations&) {
    return simulation::Resume{lookup_name(request.world())};
}

simulation::Command command_of(const v1::SetSpeed& request, const Draws&, Violations& violations) {
    simulation::SetSpeed command{.world = lookup_name(request.world()), .speed = {}};
    switch (request.speed().kind_case()) {
    case v1::Speed::kRealTimeFactor: {
        const double factor = request.speed().real_time_factor();
        if (!(factor >= simulation::speed_min && factor <= simulation::speed_max)) { // also true if the factor is NaN
            violations.push_back({"set_speed.speed.real_time_factor",
                                  number_text(simulation::speed_min) + " to " + number_text(simulation::speed_max),
                                  number_text(factor)});
        }
        command.speed = factor;
        break;
    }
    case v1::Speed::kMax:
        if (!request.speed().max()) {
            violations.push_back({"set_speed.speed.max", "true", "false"});
        }
        break;
    case v1::Speed::KIND_NOT_SET:
        violations.push_back({"set_speed.speed", "real_time_factor or max", "nothing"});
        break;
    }
    return command;
}

simulation::Command command_of(const v1::SetParameters& request, const Draws&, Violations& violations) {
    simulation::SetParameters command{.world = lookup_name(request.world()),
                                      .assignments = {},
                                      .dry_run = request.dry_run(),
                                      .expected_revision = {}};
    if (!has_too_many_assignments(request.parameters_size(), "set_parameters.parameters", violations)) {
        command.assignments = to_assignments(request.parameters(), "set_parameters.", violations);
    }
    if (request.has_expected_revision()) {
        command.expected_revision = request.expected_revision();
    }
    if (request.has_at_generation() && request.has_at_tick()) {
        violations.push_back(
            {"set_parameters.at_tick", "absent if at_generation is set", std::to_string(request.at_tick())});
    } else if (request.has_at_generation()) {
        command.at = parameters::PlannedMoment{.generation = request.at_generation(), .tick = {}};
    } else if (request.has_at_tick()) {
        command.at = parameters::PlannedMoment{.generation = {}, .tick = request.at_tick()};
    }
    return command;
}

simulation::Command command_of(const v1::CancelChange& request, const Draws&, Violations&) {
    return simulation::CancelChange{lookup_name(request.world()), request.id()};
}

simulation::Command command_of(const v1::ForkWorld& request, const Draws& draws, Violations& violations) {
    if (!simulation::is_world_name(request.name())) {
        violations.push_back(
            {"fork_world.name", std::string{simulation::world_name_allowed}, '"' + request.name() + '"'});
    }
    simulation::ForkWorld command{
        .world = lookup_name(request.world()), .name = request.name(), .at_generation = {}, .run_id = draws.run_id};
    if (request.has_at_generation()) {
        if (request.at_generation() == 0) {
            violations.push_back({"fork_world.at_generation", least_1, "0"});
        }
        command.at_generation = request.at_generation();
    }
    return command;
}

simulation::Command command_of(const v1::AddNote& request, const Draws&, Violations& violations) {
    constexpr std::string_view letters = "abcdefghijklmnopqrstuvwxyz0123456789_";
    const std::string& kind = request.kind();
    if (kind.empty() || kind.size() > note_kind_bytes_max || kind.find_first_not_of(letters) != std::string::npos) {
        violations.push_back({"add_note.kind",
                              "1 to " + std::to_string(note_kind_bytes_max) + " characters of a-z 0-9 _",
                              '"' + kind + '"'});
    }
    if (request.text().empty() || request.text().size() > note_text_bytes_max) {
        violations.push_back({"add_note.text", "1 to " + std::to_string(note_text_bytes_max) + " bytes",
                              std::to_string(request.text().size()) + " bytes"});
    }
    return simulation::AddNote{lookup_name(request.world()), kind, request.text()};
}

void add_faults(const v1::View& view, const std::string& path, Violations& violations) {
    const v1::Region& region = view.region(); // if it is absent, all its fields are 0
    const auto finite = [&](const char* field, double value) {
        if (!std::isfinite(value)) {
            violations.push_back({path + ".region." + field, "a finite number", number_text(value)});
        }
    };
    const auto positive = [&](const char* field, double value) {
        if (!(value > 0 && std::isfinite(value))) {
            violations.push_back({path + ".region." + field, "a finite number above 0", number_text(value)});
        }
    };
    if (view.has_region()) {
        finite("left_px", region.left_px());
        finite("top_px", region.top_px());
        positive("width_px", region.width_px());
        positive("height_px", region.height_px());
    }
    if (!v1::Detail_IsValid(view.detail())) {
        violations.push_back({path + ".detail", "a value of Detail", std::to_string(view.detail())});
    }
    const std::uint64_t bytes = view.bytes_per_s_max();
    if (view.has_bytes_per_s_max() && (bytes < view_bytes_per_s_least || bytes > view_bytes_per_s_most)) {
        violations.push_back({path + ".bytes_per_s_max",
                              std::to_string(view_bytes_per_s_least) + " to " + std::to_string(view_bytes_per_s_most),
                              std::to_string(bytes)});
    }
}

void add_faults(const v1::SubscribeSnapshots& request, Violations& violations) {
    if (!(request.rate_hz() > 0 && std::isfinite(request.rate_hz()))) {
        violations.push_back({"subscribe_snapshots.rate_hz", "a number above 0", number_text(request.rate_hz())});
    }
    if (!v1::Codec_IsValid(request.codec())) {
        violations.push_back({"subscribe_snapshots.codec", "a value of Codec", std::to_string(request.codec())});
    }
    if (!v1::Compression_IsValid(request.compression())) {
        violations.push_back(
            {"subscribe_snapshots.compression", "a value of Compression", std::to_string(request.compression())});
    } else if (request.compression() == v1::COMPRESSION_ZSTD && request.codec() != v1::CODEC_DELTA) {
        violations.push_back({"subscribe_snapshots.codec", "CODEC_DELTA (2) with COMPRESSION_ZSTD (2)",
                              std::to_string(request.codec())});
    }
    const std::uint32_t unacknowledged = request.unacknowledged_max();
    if (request.has_unacknowledged_max() && (unacknowledged < 1 || unacknowledged > unacknowledged_snapshots_max)) {
        violations.push_back({"subscribe_snapshots.unacknowledged_max",
                              "1 to " + std::to_string(unacknowledged_snapshots_max), std::to_string(unacknowledged)});
    }
    if (request.has_view()) {
        add_faults(request.view(), "subscribe_snapshots.view", violations);
    }
    if (request.has_view() && request.codec() != v1::CODEC_DELTA) {
        violations.push_back(
            {"subscribe_snapshots.codec", "CODEC_DELTA (2) with a view", std::to_string(request.codec())});
    }
}

void add_faults(const v1::SetView& request, Violations& violations) {
    if (request.has_view()) {
        add_faults(request.view(), "set_view.view", violations);
    } else {
        violations.push_back({"set_view.view", "a view; an empty view shows the whole island", "nothing"});
    }
}

void add_faults(const v1::ExportRun& request, Violations& violations) {
    const auto is_word = [](const auto* words, int number) {
        return number != 0 && words->FindValueByNumber(number) != nullptr;
    };
    if (!is_word(v1::RunTable_descriptor(), request.table())) {
        violations.push_back({"export_run.table", "a value of RunTable, from 1", std::to_string(request.table())});
    }
    if (request.table() == v1::RUN_TABLE_FILE) {
        if (request.format() != v1::TEXT_FORMAT_UNSPECIFIED) {
            violations.push_back(
                {"export_run.format", "absent if table is RUN_TABLE_FILE", std::to_string(request.format())});
        }
    } else if (!is_word(v1::TextFormat_descriptor(), request.format())) {
        violations.push_back({"export_run.format", "a value of TextFormat, from 1", std::to_string(request.format())});
    }
    if (request.has_generation() && request.table() != v1::RUN_TABLE_POPULATION) {
        violations.push_back({"export_run.generation", "absent unless table is RUN_TABLE_POPULATION",
                              std::to_string(request.generation())});
    }
    if (request.has_of() && request.table() != v1::RUN_TABLE_LINEAGE) {
        violations.push_back({"export_run.of", "absent unless table is RUN_TABLE_LINEAGE",
                              "generation " + std::to_string(request.of().generation())});
    }
    if (request.has_first_generation() && request.table() != v1::RUN_TABLE_LINEAGE) {
        violations.push_back({"export_run.first_generation", "absent unless table is RUN_TABLE_LINEAGE",
                              std::to_string(request.first_generation())});
    }
}

} // namespace

base::Result<simulation::Command> to_command(const v1::Request& request, const Draws& draws) {
    Violations violations;
    if (request.client_key().empty() || request.client_key().size() > client_key_bytes_max) {
        violations.push_back({"client_key", "1 to " + std::to_string(client_key_bytes_max) + " bytes",
                              std::to_string(request.client_key().size()) + " bytes"});
    }
    const simulation::Command command = [&]() -> simulation::Command {
        switch (request.kind_case()) {
        case RequestCase::kCreateWorld:
            return command_of(request.create_world(), draws, violations);
        case RequestCase::kDeleteWorld:
            return command_of(request.delete_world(), draws, violations);
        case RequestCase::kResetWorld:
            return command_of(request.reset_world(), draws, violations);
        case RequestCase::kRun:
            return command_of(request.run(), draws, violations);
        case RequestCase::kRunUntilTick:
            return command_of(request.run_until_tick(), draws, violations);
        case RequestCase::kReleaseLease:
            return command_of(request.release_lease(), draws, violations);
        case RequestCase::kPause:
            return command_of(request.pause(), draws, violations);
        case RequestCase::kResume:
            return command_of(request.resume(), draws, violations);
        case RequestCase::kAddNote:
            return command_of(request.add_note(), draws, violations);
        case RequestCase::kSetSpeed:
            return command_of(request.set_speed(), draws, violations);
        case RequestCase::kSetParameters:
            return command_of(request.set_parameters(), draws, violations);
        case RequestCase::kCancelChange:
            return command_of(request.cancel_change(), draws, violations);
        case RequestCase::kPlace:
            return command_of(request.place(), violations);
        case RequestCase::kRemove:
            return command_of(request.remove(), violations);
        case RequestCase::kSetFitness:
            return command_of(request.set_fitness(), violations);
        case RequestCase::kForkWorld:
            return command_of(request.fork_world(), draws, violations);
        default:
            violations.push_back({"request", "a command", "something else"});
            return simulation::Pause{};
        }
    }();
    if (!violations.empty()) {
        return invalid(std::move(violations));
    }
    return command;
}

std::optional<std::string> unknown_field_of(const google::protobuf::Message& message) {
    const google::protobuf::Reflection& fields = *message.GetReflection();
    if (const auto& unknown = fields.GetUnknownFields(message); !unknown.empty()) {
        return std::to_string(unknown.field(0).number());
    }
    std::vector<const google::protobuf::FieldDescriptor*> present;
    fields.ListFields(message, &present);
    for (const auto* field : present) {
        if (field->cpp_type() != google::protobuf::FieldDescriptor::CPPTYPE_MESSAGE) {
            continue;
        }
        const int count = field->is_repeated() ? fields.FieldSize(message, field) : 1;
        for (int i = 0; i < count; ++i) {
            const auto& inner =
                field->is_repeated() ? fields.GetRepeatedMessage(message, field, i) : fields.GetMessage(message, field);
            if (const auto path = unknown_field_of(inner)) {
                return field->name() + "." + *path;
            }
        }
    }
    return std::nullopt;
}

std::vector<base::Violation> faults_of(const v1::Request& request) {
    Violations violations;
    if (request.has_get_history()) {
        const v1::GetHistory& query = request.get_history();
        if (query.has_first_generation() && query.has_last_generation() &&
            query.first_generation() > query.last_generation()) {
            violations.push_back({"get_history.last_generation",
                                  "at least first_generation (" + std::to_string(query.first_generation()) + ")",
                                  std::to_string(query.last_generation())});
        }
    } else if (request.has_observe()) {
        if (const int count = request.observe().expressions_size(); count < 1 || count > int{expressions_max}) {
            violations.push_back({"observe.expressions", "1 to " + std::to_string(expressions_max) + " expressions",
                                  std::to_string(count)});
        }
    } else if (request.has_subscribe_snapshots()) {
        add_faults(request.subscribe_snapshots(), violations);
    } else if (request.has_set_view()) {
        add_faults(request.set_view(), violations);
    } else if (request.has_seek() && !request.seek().has_to()) {
        violations.push_back({"seek.to", "a RunMoment, which may be empty", "nothing"});
    } else if (request.has_close_replay() && request.close_replay().world().empty()) {
        violations.push_back({"close_replay.world", "the name of a replay opened with open_replay", "nothing"});
    } else if (request.has_export_run()) {
        add_faults(request.export_run(), violations);
    }
    return violations;
}

std::string lookup_name(const std::string& world) {
    return simulation::is_world_name(world) ? world : quotable(world);
}

base::Refusal invalid(std::vector<base::Violation> violations) {
    base::Refusal refusal{
        .code = base::RefusalCode::InvalidArgument, .message = {}, .violations = std::move(violations)};
    const Violation& first = refusal.violations.front();
    refusal.message = refusal.violations.size() == 1
                          ? first.field + ": " + text::violation_text(quotable(first.got), first.allowed)
                          : std::to_string(refusal.violations.size()) + " fields are invalid";
    return refusal;
}

} // namespace evod::protocol
