#include "server/protocol/breeding.h"

#include "server/protocol/parameters.h"

namespace evod::protocol {
namespace {

#define EVOD_NO_NAME(topic)
#define EVOD_NAME(name, ...) #name,
constexpr std::string_view genetic_parameters[] = {
    EVOD_EVOLUTION_PARAMETERS(EVOD_NO_NAME, EVOD_NAME, EVOD_NAME, EVOD_NAME, EVOD_NAME)};
#undef EVOD_NAME
#undef EVOD_NO_NAME

v1::MutationKind to_proto(evolution::ChangeKind kind) {
    switch (kind) {
    case evolution::ChangeKind::Creep:
        return v1::MUTATION_KIND_CREEP;
    case evolution::ChangeKind::Reset:
        return v1::MUTATION_KIND_RESET;
    case evolution::ChangeKind::Scale:
        return v1::MUTATION_KIND_SCALE;
    case evolution::ChangeKind::BitFlip:
        return v1::MUTATION_KIND_BIT_FLIP;
    case evolution::ChangeKind::Clamp:
        return v1::MUTATION_KIND_CLAMP;
    case evolution::ChangeKind::Reflect:
        return v1::MUTATION_KIND_REFLECT;
    case evolution::ChangeKind::Redraw:
        return v1::MUTATION_KIND_REDRAW;
    }
    return v1::MUTATION_KIND_UNSPECIFIED;
}

v1::Contender to_proto(const evolution::BreedingRecord::Contender& contender) {
    v1::Contender to;
    to.set_fitness(contender.fitness);
    to.set_rank(contender.rank);
    to.set_weight(contender.weight);
    to.set_slot_begin(contender.slot_begin);
    to.set_slot_end(contender.slot_end);
    to.set_expected_copies(contender.law.expected);
    to.set_expected_copies_error(contender.law.standard_error);
    to.set_unpicked_chance(contender.law.unpicked_chance);
    to.set_copies(contender.copies);
    if (contender.migrant) {
        to.mutable_migrant()->set_island(contender.migrant->from);
        to.mutable_migrant()->set_organism(contender.migrant->organism);
    }
    if (contender.own_fitness) {
        to.set_own_fitness(*contender.own_fitness);
    }
    return to;
}

v1::Pick to_proto(const evolution::BreedingRecord::Pick& pick) {
    v1::Pick to;
    to.set_organism(pick.organism);
    if (pick.turns) {
        to.set_turns(*pick.turns);
    }
    if (pick.tournament) {
        to.set_tournament(*pick.tournament);
    }
    to.mutable_contestants()->Add(pick.contestants.begin(), pick.contestants.end());
    return to;
}

v1::DescendantKind kind_of(std::uint32_t id, const evolution::Places& places) {
    return id < places.elite       ? v1::DESCENDANT_KIND_ELITE
           : id < places.survivors ? v1::DESCENDANT_KIND_SURVIVOR
                                   : v1::DESCENDANT_KIND_CHILD;
}

v1::Descendant to_proto(const evolution::BreedingRecord::Descendant& descendant, const evolution::Places& places,
                        evolution::OrderMutationMethod rearranging) {
    const auto add = [](const std::vector<float>& genes, auto& to) { to.Add(genes.begin(), genes.end()); };
    v1::Descendant to;
    to.set_id(descendant.id);
    to.set_kind(kind_of(descendant.id, places));
    to.set_first_parent(descendant.parents.first);
    to.set_second_parent(descendant.parents.second);
    add(descendant.first_genes, *to.mutable_first_genes());
    add(descendant.second_genes, *to.mutable_second_genes());
    const auto words = descendant.from_second.words();
    to.set_from_second(words.front());
    to.mutable_more_from_second()->Add(words.begin() + 1, words.end());
    to.set_second_share(descendant.second_share);
    add(descendant.crossed_genes, *to.mutable_crossed_genes());
    to.set_crossed(descendant.crossed);
    if (descendant.order) {
        to.mutable_order_mutation()->set_method(std::string{
            base::ChoiceNames<evolution::OrderMutationMethod>::names[static_cast<std::size_t>(rearranging)]});
        to.mutable_order_mutation()->mutable_order()->Add(descendant.order->begin(), descendant.order->end());
    }
    for (const evolution::GeneChange& change : descendant.changes) {
        v1::Mutation& mutation = *to.add_mutations();
        mutation.set_gene(change.gene);
        mutation.set_kind(to_proto(change.kind));
        mutation.set_before(change.before);
        mutation.set_after(change.after);
    }
    add(descendant.genes, *to.mutable_genes());
    return to;
}

} // namespace

evolution::WantedRows wanted_rows(const v1::GetBreeding& request) {
    return {.first_contender = request.first_contender(),
            .first_pick = request.first_pick(),
            .first_descendant = request.first_descendant(),
            .count_max = breeding_rows_max};
}

v1::Breeding to_proto(const evolution::BreedingRecord& record, const parameters::Parameters& parameters) {
    v1::Breeding to;
    for (const std::string_view name : genetic_parameters) {
        v1::ParameterAssignment& assignment = *to.add_parameters();
        assignment.set_name(std::string{name});
        *assignment.mutable_value() = to_proto(parameters::find_parameter(name)->get(parameters));
    }
    to.set_contender_count(record.contender_count);
    to.set_pick_count(record.pick_count);
    to.set_descendant_count(record.places.survivors + record.places.children);
    to.set_elite_count(record.places.elite);
    to.set_survivor_count(record.places.survivors);
    for (const auto& contender : record.contenders) {
        *to.add_contenders() = to_proto(contender);
    }
    for (const auto& pick : record.picks) {
        *to.add_picks() = to_proto(pick);
    }
    for (const auto& descendant : record.descendants) {
        *to.add_descendants() = to_proto(descendant, record.places, parameters.rearranging);
    }
    return to;
}

} // namespace evod::protocol
