#include "server/run_file/identity.h"

#include "server/parameters/experiment.h"
#include "server/run_file/rows.h"

#include <algorithm>
#include <charconv>
#include <functional>
#include <map>
#include <memory>
#include <utility>

namespace evod::run_file {
namespace {

using base::Result;

template <class T>
std::optional<T> number_from(const std::string& text, int base = 10) {
    T value{};
    const auto read = std::from_chars(text.data(), text.data() + text.size(), value, base);
    return read.ec == std::errc{} && read.ptr == text.data() + text.size() ? std::optional{value} : std::nullopt;
}

std::optional<simulation::RunId> run_id_from(const std::string& text) {
    if (text.size() != 32) {
        return std::nullopt;
    }
    const auto high = number_from<std::uint64_t>(text.substr(0, 16), 16);
    const auto low = number_from<std::uint64_t>(text.substr(16), 16);
    return high && low ? std::optional{simulation::RunId{*high, *low}} : std::nullopt;
}

/// How one key of the table `run` is converted to text and back.
struct Key {
    std::function<std::string(const StoredIdentity&)> text;
    std::function<bool(const std::string&, StoredIdentity&)> read; // false: the text is not a valid value
    bool required = true;                                          // if false, an empty text is not written
};

template <class T>
bool take(const std::optional<T>& read, T& to) {
    to = read.value_or(T{});
    return read.has_value();
}

template <class T>
Key number_key(T RunIdentity::*member) {
    return {[member](const StoredIdentity& identity) { return std::to_string(identity.run.*member); },
            [member](const std::string& text, StoredIdentity& identity) {
                return take(number_from<T>(text), identity.run.*member);
            }};
}

Key text_key(std::string RunIdentity::*member, bool required) {
    return {[member](const StoredIdentity& identity) { return identity.run.*member; },
            [member](const std::string& text, StoredIdentity& identity) {
                identity.run.*member = text;
                return true;
            },
            required};
}

Key owner_key(std::string simulation::Ownership::*member) {
    return {[member](const StoredIdentity& identity) { return identity.run.ownership.*member; },
            [member](const std::string& text, StoredIdentity& identity) {
                identity.run.ownership.*member = text;
                return true;
            },
            false};
}

/// Reads a set of parameters. Returns false if the text is not valid.
template <class To>
bool read_parameters(const std::string& text, To& to) {
    const auto experiment = parameters::parse_experiment(text);
    if (experiment) {
        to = To{experiment->parameters};
    }
    return experiment.has_value();
}

/// All keys, in the order in which they are written.
const std::vector<std::pair<std::string, Key>>& keys() {
    static const std::vector<std::pair<std::string, Key>> all = {
        {"name", text_key(&RunIdentity::name, true)},
        {"run_id",
         {[](const StoredIdentity& identity) { return to_text(identity.run.run_id); },
          [](const std::string& text, StoredIdentity& identity) {
              return take(run_id_from(text), identity.run.run_id);
          }}},
        {"seed",
         {[](const StoredIdentity& identity) { return std::to_string(identity.run.seed.value); },
          [](const std::string& text, StoredIdentity& identity) {
              return take(number_from<std::uint64_t>(text), identity.run.seed.value);
          }}},
        {"parameters",
         {[](const StoredIdentity& identity) {
              return to_experiment_text(identity.run.requested_parameters().values, parameters::Written::Everything);
          },
          [](const std::string& text, StoredIdentity& identity) {
              return read_parameters(text, identity.run.requested);
          }}},
        {"parameters_in_effect",
         {[](const StoredIdentity& identity) {
              return identity.run.requested // otherwise they are those of the key `parameters`
                         ? to_experiment_text(identity.run.parameters, parameters::Written::Everything)
                         : std::string{};
          },
          [](const std::string& text, StoredIdentity& identity) {
              return read_parameters(text, identity.run.parameters);
          },
          false}},
        {"evod_version", text_key(&RunIdentity::evod_version, true)},
        {"build", text_key(&RunIdentity::build, false)},
        {"model_version", number_key(&RunIdentity::model_version)},
        {"began_unix_ms", number_key(&RunIdentity::began_unix_ms)},
        {"first_generation", number_key(&RunIdentity::first_generation)},
        {"first_tick", number_key(&RunIdentity::first_tick)},
        {"forked_from",
         {[](const StoredIdentity& identity) {
              return identity.run.forked_from ? to_text(*identity.run.forked_from) : std::string{};
          },
          [](const std::string& text, StoredIdentity& identity) {
              identity.run.forked_from = run_id_from(text);
              return text.empty() || identity.run.forked_from;
          }}},
        {"inherited_generations", number_key(&RunIdentity::inherited_generations)},
        {"schedule",
         {[](const StoredIdentity& identity) { return to_schedule_text(identity.run.schedule); },
          [](const std::string& text, StoredIdentity& identity) {
              const auto schedule = parameters::parse_schedule(text);
              if (schedule) {
                  identity.run.schedule = *schedule;
              }
              return schedule.has_value();
          }}},
        {"owner", owner_key(&simulation::Ownership::user)},
        {"class", owner_key(&simulation::Ownership::class_name)},
        {"teacher", owner_key(&simulation::Ownership::teacher)},
        {"gene_names",
         {[](const StoredIdentity& identity) {
              std::string names;
              for (const std::string& name : evolution::gene_layout(identity.run.parameters).names) {
                  names += (names.empty() ? "" : ",") + name;
              }
              return names;
          },
          [](const std::string&, StoredIdentity&) { return true; }, // for other programs: follows from the parameters
          false}},
        {"keep_every",
         {[](const StoredIdentity& identity) { return std::to_string(identity.keep_every); },
          [](const std::string& text, StoredIdentity& identity) {
              return take(number_from<std::uint64_t>(text), identity.keep_every) && identity.keep_every > 0;
          },
          false}}};
    return all;
}

/// Whether the parameters fit the schedule. A fork may begin with any parameters. Any other run must begin with the
/// values of its schedule for generation 1.
bool begins_with_its_schedule(const RunIdentity& identity) {
    return identity.forked_from || std::ranges::all_of(identity.schedule.at(1), [&](const auto& scheduled) {
               return parameters::find_parameter(scheduled.name)->get(identity.parameters) == scheduled.value;
           });
}

Result<void> read_first_population(RunDatabase& database, RunIdentity& identity) {
    if (database.number("SELECT count(*) FROM sqlite_schema WHERE name = 'first_population'") == 0) {
        return {};
    }
    std::vector<evolution::GeneMatrix> islands;
    TableReader<FirstPopulationTable> rows{database.database, "1 ORDER BY island"};
    FirstPopulationTable::Row row;
    while (rows.next(row)) {
        if (!rows.sound() || row.island != islands.size() ||
            static_cast<std::uint64_t>(row.chromosomes.cols()) != row.organism_count) {
            return database.damaged(row_text(FirstPopulationTable::name, row.island));
        }
        islands.push_back(std::move(row.chromosomes));
    }
    if (database.failed()) {
        return database.failure();
    }
    if (islands.empty()) {
        return {};
    }
    identity.first_population = std::make_shared<const std::vector<evolution::GeneMatrix>>(std::move(islands));
    // Only a run that is not a fork begins with the first population. A reset of a fork checks whether it fits.
    if (!identity.forked_from &&
        !simulation::faults_of(identity.first_population, identity.parameters, "first_population").empty()) {
        return database.damaged("its table first_population");
    }
    return {};
}

} // namespace

void write_identity(RunDatabase& database, const StoredIdentity& identity) {
    TableWriter<RunTable> rows{database.database};
    for (const auto& [name, key] : keys()) {
        if (std::string text = key.text(identity); key.required || !text.empty()) {
            rows.write(RunTable::Row{name, std::move(text)});
        }
    }
    if (!identity.run.first_population) {
        return;
    }
    TableWriter<FirstPopulationTable> islands{database.database};
    std::uint64_t island = 0;
    for (const evolution::GeneMatrix& genes : *identity.run.first_population) {
        islands.write(FirstPopulationTable::Row{island++, static_cast<std::uint64_t>(genes.cols()), genes});
    }
}

Result<StoredIdentity> read_identity(RunDatabase& database) {
    std::map<std::string, std::string> values;
    TableReader<RunTable> rows{database.database, "1"};
    RunTable::Row row;
    const auto bad = [&](const std::string& key) {
        return database.damaged("the row \"" + key + "\" of its table run");
    };
    while (rows.next(row)) {
        if (!rows.sound()) {
            return bad(row.key);
        }
        values[row.key] = row.value;
    }
    if (database.failed()) {
        return database.failure();
    }
    StoredIdentity identity;
    identity.run.build.clear();
    for (const auto& [name, key] : keys()) {
        const auto value = values.find(name);
        if (value == values.end()) {
            if (key.required) {
                return database.damaged("its table run");
            }
        } else if (!key.read(value->second, identity)) {
            return bad(name);
        }
    }
    identity.has_parameters_in_effect = values.contains("parameters_in_effect");
    if (!identity.has_parameters_in_effect) {
        identity.run.parameters = identity.run.requested->values;
    }
    if (!identity.run.forked_from) {
        identity.run.requested.reset();
    }
    if (!begins_with_its_schedule(identity.run) ||
        identity.run.inherited_generations >= std::max<std::uint64_t>(identity.run.first_generation, 1)) {
        return database.damaged("its table run");
    }
    if (auto read = read_first_population(database, identity.run); !read) {
        return read.error();
    }
    return identity;
}

} // namespace evod::run_file
