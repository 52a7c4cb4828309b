#include "client/viewer/panels/breeding/caption.h"

#include "client/viewer/text/numbers.h"

#include <algorithm>
#include <cctype>

namespace evod::viewer {

namespace {

std::string counted(std::uint64_t count, const char* one, const char* many) {
    return with_separators(count) + " " + (count == 1 ? one : many);
}

std::string capitalise_first_letter(std::string text) {
    if (!text.empty()) {
        text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
    }
    return text;
}

/// Returns "organism 17 (rank 3, fitness 182.4)". For users, the fittest has rank 1.
std::string organism_text(const BreedingRecord& record, std::uint32_t organism) {
    const evod::v1::Contender* contender = record.contender(organism);
    if (contender == nullptr) {
        return print("organism %u", organism);
    }
    std::string text =
        print("organism %u (rank %u, fitness ", organism, contender->rank() + 1) + three_digits(contender->fitness());
    if (contender->has_own_fitness()) {
        text += " assigned by shuffling, own fitness " + three_digits(contender->own_fitness());
    }
    if (contender->has_migrant()) {
        text += print(", migrated from island %u", contender->migrant().island());
    }
    return text + ")";
}

std::string picking_caption(const BreedingRecord& record, std::uint32_t index) {
    std::string text =
        "Pick " + with_separators(index + 1) + " of " + with_separators(record.breeding().pick_count()) + ". ";
    const evod::v1::Pick* pick = record.pick(index);
    if (pick == nullptr) {
        return text + "Loading …";
    }
    const std::string winner = organism_text(record, pick->organism());
    if (pick->has_turns()) {
        text += "The pointer stopped in the slot of " + winner;
        const evod::v1::Contender* contender = record.contender(pick->organism());
        return text + (contender == nullptr
                           ? "."
                           : ", " + three_digits(100 * (contender->slot_end() - contender->slot_begin())) +
                                 " % of the wheel.");
    }
    if (pick->has_tournament()) {
        text += "Tournament " + with_separators(std::uint64_t{pick->tournament()} + 1);
        if (pick->contestants().empty()) { // there were too many contestants, or the server drew the winner directly
            return text + " is too large to show. " + capitalise_first_letter(winner) + " won.";
        }
        return text + " of " +
               counted(static_cast<std::uint64_t>(pick->contestants_size()), "contestant", "contestants") + ": " +
               winner + " won.";
    }
    return text + capitalise_first_letter(winner) + ".";
}

std::string breeding_caption(const BreedingRecord& record, std::uint32_t id) {
    std::string text = "Organism " + with_separators(id) + " of the next generation: ";
    const evod::v1::Descendant* descendant = record.descendant(id);
    if (descendant == nullptr) {
        return text + "loading …";
    }
    switch (descendant->kind()) {
    case evod::v1::DESCENDANT_KIND_ELITE:
        text += "of the elite, " + organism_text(record, descendant->first_parent()) + ", kept unchanged.";
        break;
    case evod::v1::DESCENDANT_KIND_SURVIVOR:
        text += "a survivor, " + organism_text(record, descendant->first_parent()) +
                (descendant->mutations().empty() && !descendant->has_order_mutation() ? "." : ", mutated.");
        break;
    default: {
        text += "a child of organisms " + std::to_string(descendant->first_parent()) + " and " +
                std::to_string(descendant->second_parent()) +
                (descendant->first_parent() == descendant->second_parent() ? ", the same organism twice" : "") +
                (descendant->second_share() > 0 ? print(", blended with weights %.3f and %.3f",
                                                        1 - descendant->second_share(), descendant->second_share())
                 : descendant->crossed()        ? ""
                                                : ", not crossed");
        const auto mutated = std::ranges::count_if(descendant->mutations(), [](const evod::v1::Mutation& mutation) {
            return mutation.kind() != evod::v1::MUTATION_KIND_CLAMP;
        });
        if (descendant->has_order_mutation()) {
            text += ", " + shown_choice(descendant->order_mutation().method()) + " reordered genes";
        }
        text += mutated == 0 ? ", no mutation."
                             : ", " + counted(static_cast<std::uint64_t>(mutated), "mutation.", "mutations.");
    }
    }
    return text;
}

} // namespace

std::string shown_choice(std::string choice) {
    std::ranges::replace(choice, '_', ' ');
    return choice;
}

std::string selection_law_text(const BreedingRecord& record) {
    const std::string method = record.choice("selection"), scaling = record.choice("fitness_scaling");
    if (method == "tournament") {
        const double size = record.number("tournament_size").value_or(0),
                     winners = record.number("tournament_winners").value_or(1);
        return "Tournament: " + three_digits(size) + " organisms are drawn at random, and the fittest " +
               (winners > 1 ? three_digits(winners) + " of them are picked." : "of them is picked.") +
               " Larger tournaments favour the fittest more.";
    }
    if (method == "random") {
        return "Random: every organism has the same chance in every pick. Fitness does not matter.";
    }
    if (method == "truncation") {
        return "Truncation: the best organisms are picked in order of rank, then again from the first, until all picks "
               "are made. There is no luck.";
    }
    const std::string law =
        method == "stochastic_universal"
            ? "Universal sampling: one spin sets all pointers at equal distances, so each organism is picked its "
              "expected number of times, rounded up or down."
            : "Roulette wheel: the wheel is spun for each pick. An organism with twice the weight is picked twice as "
              "often on average.";
    const bool any_negative = std::ranges::any_of(
        record.breeding().contenders(), [](const evod::v1::Contender& contender) { return contender.fitness() < 0; });
    return law + (scaling == "none" && !any_negative            ? " The weight is the fitness."
                  : scaling == "none" || scaling == "windowing" ? " The weight is the fitness minus the lowest fitness."
                                                                : " The weight depends on the rank alone.");
}

std::string breeding_summary(const BreedingRecord& record) {
    if (!record.known()) {
        return "";
    }
    const evod::v1::Breeding& breeding = record.breeding();
    const std::string method = record.choice("selection"), scaling = record.choice("fitness_scaling");
    std::string text = capitalise_first_letter(shown_choice(method));
    if (method == "tournament") {
        text += print(" of %g", record.number("tournament_size").value_or(0));
    } else if ((method == "roulette" || method == "stochastic_universal") && scaling != "none") {
        text += " with " + shown_choice(scaling);
    }
    text += " · " + shown_choice(record.choice("population_model")) + " · " +
            counted(breeding.contender_count(), "organism", "organisms") + ", " +
            counted(breeding.pick_count(), "pick", "picks") + ": " +
            counted(breeding.survivor_count(), "survivor", "survivors");
    if (breeding.elite_count() > 0) {
        text += " (" + with_separators(breeding.elite_count()) + " of the elite)";
    }
    text += " and " + counted(breeding.descendant_count() - breeding.survivor_count(), "child", "children");
    if (record.number("shuffle_fitness") == 1.0) {
        text += " · fitness shuffled among organisms";
    }
    return text;
}

std::string caption(const BreedingRecord& record, Moment moment) {
    if (!record.known()) {
        return "";
    }
    switch (moment.stage) {
    case BreedingStage::Scaling:
        return selection_law_text(record);
    case BreedingStage::Picking:
        return picking_caption(record, moment.index);
    case BreedingStage::Breeding:
        return breeding_caption(record, moment.index);
    case BreedingStage::Done:
        break;
    }
    const evod::v1::Breeding& breeding = record.breeding();
    return "The next generation: " + counted(breeding.survivor_count(), "survivor", "survivors") + " and " +
           counted(breeding.descendant_count() - breeding.survivor_count(), "child", "children") +
           ". A dot marks each organism that was picked.";
}

} // namespace evod::viewer
