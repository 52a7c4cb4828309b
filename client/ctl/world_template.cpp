#include "client/ctl/world_template.h"

#include "client/ctl/input_file.h"
#include "client/ctl/stop.h"
#include "proto/codec/framing.h"
#include "proto/files/input_file.h"

namespace evod::ctl {

void add_experiment(const std::string& path, v1::CreateWorld& command) {
    command.set_experiment_json(text_in(path, "an experiment file", files::experiment_bytes_max));
    if (command.experiment_json().empty()) {
        throw Stop{ExitCode::Usage, "the experiment file " + path + " is empty"};
    }
}

void add_population(const std::string& path, v1::CreateWorld& command) {
    const codec::Population population = population_in(path, choices_in(command.experiment_json()));
    for (const std::vector<float>& genes : population.islands) {
        command.add_population()->mutable_genes()->Assign(genes.begin(), genes.end());
    }
    command.mutable_population_gene_names()->Assign(population.gene_names.begin(), population.gene_names.end());
    // This many bytes are reserved for the other fields of the request, which need much less.
    constexpr std::size_t rest_bytes_max = 32 << 10;
    if (command.ByteSizeLong() + rest_bytes_max > *codec::server_limits.control_bytes_max) {
        throw Stop{ExitCode::Usage, "the population file " + path +
                                        " is too large for a request (about 43,000 organisms): start such a world with "
                                        "evod --population"};
    }
}

} // namespace evod::ctl
