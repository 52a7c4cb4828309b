// A breeding as a server would send it, small enough to be checked by eye.
#pragma once

#include "client/viewer/panels/breeding/breeding_record.h"

#include <cmath>

namespace evod::viewer::made_up {

inline void set_choice(evod::v1::Breeding& breeding, const char* name, const char* choice) {
    auto& parameter = *breeding.add_parameters();
    parameter.set_name(name);
    parameter.mutable_value()->set_choice(choice);
}

inline void set_count(evod::v1::Breeding& breeding, const char* name, std::uint32_t count) {
    auto& parameter = *breeding.add_parameters();
    parameter.set_name(name);
    parameter.mutable_value()->set_count(count);
}

/// The record after the server has sent `breeding`, generation 7 of island 1.
inline BreedingRecord record_of(const evod::v1::Breeding& breeding) {
    BreedingRecord record{{.world = "default", .run_id = "a", .island = 1, .generation = 7}};
    record.add(breeding);
    return record;
}

/// Four organisms of fitness 40, 10, 30, 20 on a roulette wheel; picks 0, 2, 0, 3.
inline evod::v1::Breeding wheel() {
    evod::v1::Breeding breeding;
    breeding.set_generation(7);
    breeding.set_island(1);
    set_choice(breeding, "selection", "roulette");
    set_choice(breeding, "fitness_scaling", "none");
    set_choice(breeding, "population_model", "generational");
    breeding.set_contender_count(4);
    breeding.set_pick_count(4);
    breeding.set_descendant_count(4);
    const double fitness[] = {40, 10, 30, 20};
    const unsigned rank[] = {0, 3, 1, 2}, copies[] = {2, 0, 1, 1};
    double end = 0;
    for (int i = 0; i < 4; ++i) {
        auto& contender = *breeding.add_contenders();
        contender.set_fitness(fitness[i]);
        contender.set_weight(fitness[i]);
        contender.set_rank(rank[i]);
        contender.set_slot_begin(end);
        contender.set_slot_end(end += fitness[i] / 100);
        const double share = fitness[i] / 100;
        contender.set_expected_copies(4 * share);
        contender.set_expected_copies_error(std::sqrt(4 * share * (1 - share)));
        contender.set_unpicked_chance(std::pow(1 - share, 4));
        contender.set_copies(copies[i]);
    }
    const std::uint32_t picked[] = {0, 2, 0, 3};
    const double turns[] = {0.25, 0.625, 0.125, 0.875};
    for (int i = 0; i < 4; ++i) {
        auto& pick = *breeding.add_picks();
        pick.set_organism(picked[i]);
        pick.set_turns(turns[i]);
    }
    for (std::uint32_t i = 0; i < 4; ++i) {
        auto& descendant = *breeding.add_descendants();
        descendant.set_id(i);
        descendant.set_kind(evod::v1::DESCENDANT_KIND_CHILD);
    }
    return breeding;
}

/// A child with six genes: 1 to 6 in the first parent, 11 to 16 in the second.
inline evod::v1::Descendant child(std::uint32_t from_second) {
    evod::v1::Descendant child;
    child.set_id(30);
    child.set_kind(evod::v1::DESCENDANT_KIND_CHILD);
    child.set_first_parent(4);
    child.set_second_parent(9);
    child.set_crossed(true);
    child.set_from_second(from_second);
    for (int gene = 1; gene <= 6; ++gene) {
        child.add_first_genes(static_cast<float>(gene));
        child.add_second_genes(static_cast<float>(10 + gene));
    }
    return child;
}

inline void mutate(evod::v1::Descendant& child, evod::v1::MutationKind kind, std::uint32_t gene, float before,
                   float after) {
    auto& mutation = *child.add_mutations();
    mutation.set_kind(kind);
    mutation.set_gene(gene);
    mutation.set_before(before);
    mutation.set_after(after);
}

} // namespace evod::viewer::made_up
