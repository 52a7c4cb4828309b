#include "client/viewer/world/new_world.h"

#include "client/viewer/text/numbers.h"
#include "proto/codec/population_csv.h"
#include "proto/text/number_text.h"

#include <algorithm>
#include <limits>
#include <map>

namespace evod::viewer {

namespace {

constexpr std::size_t name_bytes_max = 64;

bool is_digit(char sign) {
    return sign >= '0' && sign <= '9';
}

std::string json_text(const evod::v1::ParameterValue& value) {
    switch (value.kind_case()) {
    case evod::v1::ParameterValue::kReal:
        return text::number_text(value.real());
    case evod::v1::ParameterValue::kCount:
        return std::to_string(value.count());
    case evod::v1::ParameterValue::kFlag:
        return value.flag() ? "true" : "false";
    default: // a choice is a word without quotes or backslashes
        return "\"" + value.choice() + "\"";
    }
}

core::Error refused(std::string what) {
    return {.kind = core::Error::Kind::Usage, .what = std::move(what)};
}

void assign_count(evod::v1::CreateWorld& command, const char* name, std::size_t count) {
    auto& parameter = *command.add_parameters();
    parameter.set_name(name);
    parameter.mutable_value()->set_count(static_cast<std::uint32_t>(count));
}

} // namespace

std::string name_problem(std::string_view field, std::string_view name) {
    const bool allowed = !name.empty() && name.size() <= name_bytes_max && std::ranges::all_of(name, [](char sign) {
        return is_digit(sign) || (sign >= 'a' && sign <= 'z') || (sign >= 'A' && sign <= 'Z') || sign == '_' ||
               sign == '-';
    });
    return allowed ? ""
                   : std::string{field} + ": got \"" + std::string{name} +
                         "\", allowed 1 to 64 characters of a-z A-Z 0-9 _ -";
}

std::string unused_name(std::string_view base, std::span<const std::string> used) {
    const auto free = [&](std::string_view name) { return std::ranges::find(used, name) == used.end(); };
    if (free(base)) {
        return std::string{base};
    }
    std::size_t digits = base.size();
    while (digits > 0 && is_digit(base[digits - 1])) {
        --digits;
    }
    if (digits > 1 && digits < base.size() && base[digits - 1] == '-') {
        base = base.substr(0, digits - 1);
    }
    for (std::size_t number = 2;; ++number) {
        const std::string end = "-" + std::to_string(number);
        const std::string name = std::string{base.substr(0, name_bytes_max - end.size())} + end;
        if (free(name)) {
            return name;
        }
    }
}

std::string experiment_json(const evod::v1::ParameterSet& set) {
    std::map<std::string, std::string> later; // by parameter: ", "20": 15, "40": 4"
    for (const evod::v1::ScheduledValue& value : set.schedule()) {
        later[value.name()] += ", \"" + std::to_string(value.generation()) + "\": " + json_text(value.value());
    }
    std::string text = "{";
    for (const evod::v1::ParameterState& parameter : set.parameters()) {
        const std::string now = json_text(parameter.has_pending() ? parameter.pending() : parameter.value());
        const auto scheduled = later.find(parameter.name());
        text += (text.size() > 1 ? ",\n  \"" : "\n  \"") + parameter.name() +
                "\": " + (scheduled == later.end() ? now : "{\"1\": " + now + scheduled->second + "}");
    }
    return text + "\n}\n";
}

core::Result<evod::v1::Request> create_request(const NewWorldForm& wanted) {
    if (std::string problem = name_problem("name", wanted.name); !problem.empty()) {
        return refused(std::move(problem));
    }
    evod::v1::Request request;
    evod::v1::CreateWorld& command = *request.mutable_create_world();
    command.set_name(wanted.name);
    if (!wanted.seed.empty()) {
        std::string problem;
        const auto seed = number_in("seed", wanted.seed, 0, std::numeric_limits<std::uint64_t>::max(), problem);
        if (!seed) {
            return refused(std::move(problem));
        }
        command.set_seed(*seed);
    }
    command.set_experiment_json(wanted.experiment_json);
    const codec::Population& population = wanted.population;
    for (std::size_t island = 0; island < population.islands.size(); ++island) {
        const std::size_t first = population.organism_count(0), count = population.organism_count(island);
        if (count != first) {
            return refused("population: got islands of " + std::to_string(first) + " and " + std::to_string(count) +
                           " organisms, allowed the same number on each island");
        }
        const std::vector<float>& genes = population.islands[island];
        command.add_population()->mutable_genes()->Assign(genes.begin(), genes.end());
    }
    if (!population.islands.empty()) {
        command.mutable_population_gene_names()->Assign(population.gene_names.begin(), population.gene_names.end());
        assign_count(command, "population_size", population.organism_count(0));
        assign_count(command, "island_count", population.islands.size());
    }
    constexpr std::size_t rest_bytes_max = 1 << 10; // of the frame around the command
    if (request.ByteSizeLong() + rest_bytes_max > *codec::server_limits.control_bytes_max) {
        return refused(wanted.population.islands.empty()
                           ? "parameters: got " + std::to_string(wanted.experiment_json.size()) +
                                 " bytes, allowed 1,000,000"
                           : "population: too large for a request, which allows about 43,000 organisms; start such a "
                             "world with evod --population");
    }
    return request;
}

} // namespace evod::viewer
