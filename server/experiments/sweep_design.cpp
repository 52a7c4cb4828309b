#include "server/experiments/sweep_design.h"

#include <algorithm>
#include <numeric>
#include <span>
#include <utility>

namespace evod::experiments {
namespace {

using parameters::JsonMember;
using parameters::JsonNode;
using parameters::ParameterDescription;
using parameters::ParameterValue;

bool has_too_many_runs(const std::string& field, const JsonNode& node, std::size_t cells, const Sweep& sweep,
                       SweepErrors& errors) {
    if (cells <= Sweep::runs_max / sweep.replicates) {
        return false;
    }
    errors.add(parameters::with_line(field, node.line), "at most " + std::to_string(Sweep::runs_max) + " runs",
               std::to_string(cells) + " cells of " + std::to_string(sweep.replicates) + " replicates");
    return true;
}

/// A value, and the index of its parameter in Sweep::swept.
using ColumnValue = std::pair<std::size_t, ParameterValue>;

/// Reads the values in each element of a list. Adds each new parameter to sweep.swept in order of appearance.
std::vector<std::vector<ColumnValue>> read_list_cells(const JsonNode& list, Sweep& sweep, SweepErrors& errors) {
    std::vector<std::vector<ColumnValue>> given(list.elements.size());
    for (std::size_t cell = 0; cell < given.size(); ++cell) {
        const std::string prefix = "list[" + std::to_string(cell) + "].";
        for (const JsonMember* member : parameters::unique_members(list.elements[cell], prefix, errors.violations)) {
            const ParameterDescription* parameter = find_swept(*member, prefix + member->name, errors);
            if (parameter == nullptr) {
                continue;
            }
            auto value = read_swept_value(*parameter, prefix + member->name, member->value, errors);
            if (!value) {
                continue;
            }
            auto column = std::ranges::find(sweep.swept, parameter);
            if (column == sweep.swept.end()) {
                column = sweep.swept.insert(column, parameter);
            }
            given[cell].emplace_back(column - sweep.swept.begin(), *std::move(value));
        }
    }
    return given;
}

void read_list(const JsonNode& list, Sweep& sweep, SweepErrors& errors) {
    if (!list.is_array() || list.elements.empty() || !std::ranges::all_of(list.elements, &JsonNode::is_object)) {
        return errors.add("list", list, "a list of at least one object with parameter values");
    }
    if (has_too_many_runs("list", list, list.elements.size(), sweep, errors)) {
        return;
    }
    auto given = read_list_cells(list, sweep, errors);
    std::vector<ParameterValue> defaults; // values of the experiment
    for (const ParameterDescription* parameter : sweep.swept) {
        defaults.push_back(parameter->get(sweep.parameters));
    }
    sweep.cells.assign(given.size(), defaults);
    for (std::size_t cell = 0; cell < given.size(); ++cell) {
        for (auto& [column, value] : given[cell]) {
            sweep.cells[cell][column] = std::move(value);
        }
    }
}

/// Adds the values of the range to the dimension. If several steps round to the same whole number, adds it once.
void add_steps(Dimension& dimension) {
    for (std::size_t i = 0; i < dimension.steps; ++i) {
        auto value = dimension.range->step(i, dimension.steps);
        if (dimension.values.empty() || dimension.values.back() != value) {
            dimension.values.push_back(std::move(value));
        }
    }
}

void read_grid(const JsonMember& grid, Sweep& sweep, SweepErrors& errors) {
    if (!grid.value.is_object() || grid.value.members.empty()) {
        return errors.add("grid", grid.value, "an object with the values of each parameter");
    }
    std::vector<Dimension> dimensions;
    std::size_t cells = 1;
    for (const JsonMember* member : parameters::unique_members(grid.value, "grid.", errors.violations)) {
        auto dimension = read_dimension(*member, "grid." + member->name, Steps::Needed, errors);
        if (!dimension) {
            continue;
        }
        if (dimension->range) {
            add_steps(*dimension);
        }
        cells = std::min(cells * dimension->values.size(), Sweep::runs_max + 1);
        sweep.swept.push_back(dimension->parameter);
        dimensions.push_back(*std::move(dimension));
    }
    if (!errors.violations.empty() || has_too_many_runs("grid", grid.value, cells, sweep, errors)) {
        return;
    }
    sweep.cells.resize(cells);
    for (std::size_t cell = 0; cell < cells; ++cell) {
        std::vector<ParameterValue>& values = sweep.cells[cell];
        values.resize(dimensions.size());
        std::size_t rest = cell;
        for (std::size_t d = dimensions.size(); d-- > 0; rest /= dimensions[d].values.size()) {
            values[d] = dimensions[d].values[rest % dimensions[d].values.size()];
        }
    }
}

/// Divides the range of each parameter into `samples` parts of equal probability, and draws one sample from each part.
/// The parts of different parameters are combined at random.
void draw_samples(const std::vector<Dimension>& dimensions, std::uint32_t samples, Sweep& sweep) {
    sweep.cells.assign(samples, std::vector<ParameterValue>(dimensions.size()));
    const base::RandomKey key{sweep.seed, base::Purpose::LatinHypercube, 0, 0};
    std::vector<std::uint32_t> part(samples);
    for (std::uint32_t d = 0; d < dimensions.size(); ++d) {
        const Dimension& dimension = dimensions[d];
        base::RandomStream random{key, d};
        std::iota(part.begin(), part.end(), 0u);
        random.shuffle(std::span{part});
        for (std::uint32_t i = 0; i < samples; ++i) {
            const double u = (part[i] + random.uniform()) / samples;
            if (dimension.range) {
                sweep.cells[i][d] = dimension.range->quantile(u);
                continue;
            }
            const std::size_t count = dimension.values.size();
            const auto index = static_cast<std::size_t>(u * static_cast<double>(count));
            sweep.cells[i][d] = dimension.values[std::min(index, count - 1)];
        }
    }
}

/// The members of the object "latin_hypercube" in a sweep file.
struct Hypercube {
    std::uint32_t samples = 0;
    const JsonNode* parameters = nullptr;
};
std::optional<Hypercube> read_hypercube(const JsonNode& node, SweepErrors& errors) {
    const std::size_t errors_before = errors.violations.size();
    Hypercube hypercube;
    for (const JsonMember* member : parameters::unique_members(node, "latin_hypercube.", errors.violations)) {
        const std::string field = "latin_hypercube." + member->name;
        if (member->name == "samples") {
            const auto count = member->value.whole_number();
            if (count && *count >= 1 && *count <= Sweep::runs_max) {
                hypercube.samples = static_cast<std::uint32_t>(*count);
            } else {
                errors.add(field, member->value, "a whole number, 1 to " + std::to_string(Sweep::runs_max));
            }
        } else if (member->name == "parameters") {
            hypercube.parameters = &member->value;
        } else {
            errors.add(parameters::with_line(field, member->line), "samples, parameters", base::unknown_name);
        }
    }
    if (errors.violations.size() > errors_before) {
        return std::nullopt;
    }
    if (hypercube.samples == 0 || hypercube.parameters == nullptr) {
        errors.add(parameters::with_line("latin_hypercube", node.line), "samples and parameters",
                   std::string{"no "} + (hypercube.samples == 0 ? "samples" : "parameters"));
        return std::nullopt;
    }
    if (!hypercube.parameters->is_object() || hypercube.parameters->members.empty()) {
        errors.add("latin_hypercube.parameters", *hypercube.parameters, "an object with the values of each parameter");
        return std::nullopt;
    }
    return hypercube;
}

void read_latin_hypercube(const JsonMember& design, Sweep& sweep, SweepErrors& errors) {
    if (!design.value.is_object()) {
        return errors.add(design.name, design.value, "an object with \"samples\" and \"parameters\"");
    }
    const auto hypercube = read_hypercube(design.value, errors);
    if (!hypercube) {
        return;
    }
    const std::string prefix = "latin_hypercube.parameters.";
    std::vector<Dimension> dimensions;
    for (const JsonMember* member : parameters::unique_members(*hypercube->parameters, prefix, errors.violations)) {
        if (auto dimension = read_dimension(*member, prefix + member->name, Steps::None, errors)) {
            sweep.swept.push_back(dimension->parameter);
            dimensions.push_back(*std::move(dimension));
        }
    }
    if (errors.violations.empty() &&
        !has_too_many_runs("latin_hypercube.samples", design.value, hypercube->samples, sweep, errors)) {
        draw_samples(dimensions, hypercube->samples, sweep);
    }
}

} // namespace

void read_design(const JsonMember& design, Sweep& sweep, SweepErrors& errors) {
    if (design.name == "list") {
        read_list(design.value, sweep, errors);
    } else if (design.name == "grid") {
        read_grid(design, sweep, errors);
    } else {
        read_latin_hypercube(design, sweep, errors);
    }
}

} // namespace evod::experiments
