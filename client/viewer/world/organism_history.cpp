#include "client/viewer/world/organism_history.h"

#include <algorithm>
#include <limits>

namespace evod::viewer {

void OrganismHistory::add(const codec::ReceivedSnapshot& snapshot) {
    if (snapshot.about.generation() != generation_) {
        ended_ = true;
        // Only the next generation contains the organism's children.
        too_late_ = too_late_ || snapshot.about.generation() != generation_ + 1;
        return;
    }
    const double s = snapshot.about.simulated_s();
    const codec::Entities& organisms = snapshot.entities->organisms;
    const auto index = organisms.index_of(id_);
    if (ended_ || !index || (!health_.empty() && s <= health_.back().s)) {
        return;
    }
    if (health_.size() == points_max) {
        for (std::size_t i = 0; i < points_max / 2; ++i) {
            health_[i] = health_[2 * i];
        }
        health_.resize(points_max / 2);
    }
    health_.push_back({s, organisms.health(*index)});
}

void OrganismHistory::add(const evod::v1::OrganismInfo& info) {
    if (info.generation() == generation_ && info.id() == id_) {
        info_ = info;
    }
}

void OrganismHistory::add(const Population& population) {
    if (population.generation() == generation_ && ranges_.empty()) {
        for (std::size_t gene = 0; gene < population.gene_count(); ++gene) {
            ranges_.push_back(population.range(gene));
        }
    }
    if (population.generation() != generation_ + 1 || children_) {
        return;
    }
    children_.emplace();
    for (const std::uint32_t id : population.children_of(id_)) {
        const std::uint32_t first = population.first_parent(id), second = population.second_parent(id);
        Child child{.id = id};
        if (first != second) {
            child.other_parent = first == id_ ? second : first;
        } else if (info_ && static_cast<std::size_t>(info_->genes_size()) == population.gene_count()) {
            child.same_genes = true;
            for (std::size_t gene = 0; gene < population.gene_count(); ++gene) {
                child.same_genes =
                    child.same_genes && population.gene(gene)[id] == info_->genes(static_cast<int>(gene));
            }
        }
        children_->push_back(child);
    }
}

std::optional<evod::v1::GetBreeding> OrganismHistory::wanted_parent() const {
    if (!info_) {
        return std::nullopt;
    }
    const auto missing =
        std::ranges::find_if(info_->parents(), [&](std::uint32_t id) { return parent(id) == nullptr; });
    if (missing == info_->parents().end()) {
        return std::nullopt;
    }
    evod::v1::GetBreeding request;
    request.set_generation(generation_ - 1);
    request.set_first_contender(*missing);
    // The answer contains no rows of these lists.
    request.set_first_pick(std::numeric_limits<std::uint32_t>::max());
    request.set_first_descendant(std::numeric_limits<std::uint32_t>::max());
    return request;
}

void OrganismHistory::add(const evod::v1::GetBreeding& request, const evod::v1::Breeding& breeding) {
    if (breeding.contenders().empty() || breeding.generation() != request.generation() ||
        breeding.generation() + 1 != generation_) {
        return;
    }
    origin_ = id_ < breeding.elite_count()      ? Origin::Elite
              : id_ < breeding.survivor_count() ? Origin::Survivor
                                                : Origin::Child;
    Parent& parent = parents_.emplace_back(Parent{.id = request.first_contender()});
    if (breeding.contenders(0).has_migrant()) {
        parent.migrant = breeding.contenders(0).migrant();
    }
}

const OrganismHistory::Parent* OrganismHistory::parent(std::uint32_t id) const {
    const auto found = std::ranges::find(parents_, id, &Parent::id);
    return found == parents_.end() ? nullptr : &*found;
}

} // namespace evod::viewer
