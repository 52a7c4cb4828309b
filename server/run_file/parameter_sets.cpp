#include "server/run_file/parameter_sets.h"

#include "server/parameters/experiment.h"
#include "server/run_file/rows.h"

namespace evod::run_file {

base::Result<parameters::ParameterSet> ParameterSets::read(std::int64_t number) {
    if (read_ && read_->number == number) {
        return read_->set;
    }
    TableReader<ParametersTable> reader{database_.database, "number = ?", {number}};
    ParametersTable::Row row;
    const bool found = reader.next(row);
    const auto active = parameters::parse_experiment(row.active);
    const auto requested = parameters::parse_experiment(row.requested);
    if (!found || !reader.sound() || !active || !requested) {
        return database_.damaged(row_text(ParametersTable::name, static_cast<std::uint64_t>(number)));
    }
    parameters::ParameterSet set;
    set.revision = row.revision;
    set.active = active->parameters;
    set.requested = parameters::RequestedParameters{requested->parameters};
    read_ = Numbered{number, set};
    return set;
}

base::Result<void> ParameterSets::set_generation_limit(std::uint32_t limit) {
    const std::int64_t last = database_.number("SELECT max(number) FROM parameters");
    for (std::int64_t number = 1; number <= last; ++number) {
        auto set = read(number);
        if (!set) {
            return set.error();
        }
        set->active.generation_limit = set->requested.values.generation_limit = limit;
        write(number, *set);
    }
    read_.reset();
    written_.reset();
    return {};
}

void ParameterSets::write(std::int64_t number, const parameters::ParameterSet& set) {
    using parameters::Written;
    TableWriter<ParametersTable>{database_.database}.write(
        ParametersTable::Row{number, set.revision, to_experiment_text(set.active, Written::Everything),
                             to_experiment_text(set.requested.values, Written::Everything)});
}

std::int64_t ParameterSets::number_of(const parameters::ParameterSet& set) {
    if (written_ && written_->set.revision == set.revision && written_->set.active == set.active &&
        written_->set.requested == set.requested) {
        return written_->number;
    }
    const std::int64_t number =
        1 + (written_ ? written_->number : database_.number("SELECT max(number) FROM parameters"));
    write(number, set);
    written_ = Numbered{number, set};
    return number;
}

} // namespace evod::run_file
