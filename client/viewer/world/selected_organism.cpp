#include "client/viewer/world/selected_organism.h"

namespace evod::viewer {

void SelectedOrganism::add(const evod::v1::OrganismInfo& info) {
    if (info.generation() == generation_ && info.id() == id_) {
        info_ = info;
    }
}

void SelectedOrganism::add(const Population& population) {
    if (population.generation() == generation_ && ranges_.empty()) {
        for (std::size_t gene = 0; gene < population.gene_count(); ++gene) {
            ranges_.push_back(population.range(gene));
        }
    }
}

} // namespace evod::viewer
