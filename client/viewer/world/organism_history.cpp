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

std::optional<evod::v1::GetBreeding> OrganismHistory::wanted_picks(bool has_bred) const {
    evod::v1::GetBreeding request;
    // The answer contains no rows of these lists.
    request.set_first_pick(std::numeric_limits<std::uint32_t>::max());
    request.set_first_descendant(std::numeric_limits<std::uint32_t>::max());
    if (info_) {
        for (const std::uint32_t parent : info_->parents()) {
            if (picks_of_parent(parent) == nullptr) {
                request.set_generation(generation_ - 1);
                request.set_first_contender(parent);
                return request;
            }
        }
    }
    if (has_bred && !picks_) {
        request.set_generation(generation_);
        request.set_first_contender(id_);
        return request;
    }
    return std::nullopt;
}

void OrganismHistory::add(const evod::v1::GetBreeding& request, const evod::v1::Breeding& breeding) {
    if (breeding.contenders().empty() || breeding.generation() != request.generation()) {
        return;
    }
    const evod::v1::Contender& contender = breeding.contenders(0);
    Picks picks{.organism = request.first_contender(),
                .count = contender.copies(),
                .all = breeding.pick_count(),
                .expected = contender.expected_copies()};
    if (contender.has_migrant()) {
        picks.migrant = contender.migrant();
    }
    if (breeding.generation() == generation_) {
        picks_ = std::move(picks);
    } else if (breeding.generation() + 1 == generation_) {
        origin_ = id_ < breeding.elite_count()      ? Origin::Elite
                  : id_ < breeding.survivor_count() ? Origin::Survivor
                                                    : Origin::Child;
        parent_picks_.push_back(std::move(picks));
    }
}

const OrganismHistory::Picks* OrganismHistory::picks_of_parent(std::uint32_t parent) const {
    const auto found = std::ranges::find(parent_picks_, parent, &Picks::organism);
    return found == parent_picks_.end() ? nullptr : &*found;
}

} // namespace evod::viewer
