#include "server/experiments/verdict.h"

#include "server/base/assert.h"

#include <algorithm>
#include <cstdio>

namespace evod::experiments {
namespace {

std::string p_text(const Finding& finding) {
    char text[48];
    std::snprintf(text, sizeof text, "adjusted p = %.2g", finding.adjusted_p);
    return text;
}

class Sentences {
  public:
    Sentences(const std::vector<ControlResult>& results, int decimals) : results_{results}, decimals_{decimals} {
        tests_ = static_cast<std::size_t>(
            std::ranges::count_if(results, [](const ControlResult& result) { return result.finding.has_value(); }));
    }

    std::string text(double value) const { return signed_text(value, decimals_); }
    const ControlResult& of(ControlKind kind) const {
        return *std::ranges::find(results_, kind, [](const ControlResult& result) { return result.control.kind; });
    }
    Judgement judgement(ControlKind kind) const { return judge(*of(kind).finding, tests_); }

    std::string answer(double rise, const Interval& interval) const;
    std::string mutation_sentence(double rise) const;
    std::string poison_sentence(double rise) const;

  private:
    /// Formats a difference: "+121.3 against random selection (adjusted p = 7.6e-06)".
    std::string difference(ControlKind kind, const char* name) const {
        const Finding& finding = *of(kind).finding;
        return text(finding.mean) + " against " + name + " (" + p_text(finding) + ")";
    }

    const std::vector<ControlResult>& results_;
    int decimals_;
    std::size_t tests_ = 0;
};

std::string Sentences::answer(double rise, const Interval& interval) const {
    const std::string question = "Did evolution do it? ";
    for (const ControlKind kind : {ControlKind::RandomSelection, ControlKind::ShuffledFitness}) {
        if (const std::string& why = of(kind).control.cannot_differ; !why.empty()) {
            return question + "No: " + why + ", so no organism is selected for its fitness.";
        }
    }
    const Judgement judgements[] = {judgement(ControlKind::RandomSelection), judgement(ControlKind::ShuffledFitness)};
    const std::string differences = difference(ControlKind::RandomSelection, "random selection") + ", " +
                                    difference(ControlKind::ShuffledFitness, "shuffled fitness");
    const auto any = [&](Judgement judgement) { return std::ranges::count(judgements, judgement) > 0; };
    if (any(Judgement::Below)) {
        return question + "No: selection for fitness makes the fitness lower: " + differences + ".";
    }
    if (any(Judgement::CannotBeShown)) {
        return question +
               "There are too few replicates to answer: no difference, however large, can have an adjusted p below "
               "0.05. " +
               "Use more replicates.";
    }
    if (any(Judgement::NotShown)) {
        return question + "That is not shown: " + differences + "; both p must be below 0.05.";
    }
    // If the fitness did not rise, selection may only have prevented a fall.
    const std::string how = interval.low > 0 ? "Yes: the mean fitness rose by " + text(rise).substr(1) +
                                                   ", and selection for fitness is the cause: "
                                             : "Yes, but the mean fitness is not shown to have risen (" + text(rise) +
                                                   "): selection for fitness only kept it above the controls, ";
    return question + how + differences + ".";
}

std::string Sentences::mutation_sentence(double rise) const {
    const ControlResult& result = of(ControlKind::MutationOff);
    if (!result.finding) {
        return "Mutation: " + result.control.cannot_differ +
               "; selection acts on the variety of the first generation only.";
    }
    const std::string without =
        "without mutation the rise is " + text(rise - result.finding->mean) + " (" + p_text(*result.finding) + "): ";
    switch (judgement(ControlKind::MutationOff)) {
    case Judgement::Above:
        return "Mutation: " + without + "new variety adds to the variety of the first generation.";
    case Judgement::Below:
        return "Mutation: " + without + "it costs more than it gains in this number of generations.";
    case Judgement::NotShown:
    case Judgement::CannotBeShown:
        break;
    }
    return "Mutation: " + without + "an effect of new variety is not shown.";
}

std::string Sentences::poison_sentence(double rise) const {
    const ControlResult& result = of(ControlKind::HarmlessPoison);
    if (!result.finding) {
        return "Poison: " + result.control.cannot_differ + ".";
    }
    const std::string without = "with harmless poison the rise is " + text(rise - result.finding->mean) + " (" +
                                p_text(*result.finding) + "): ";
    switch (judgement(ControlKind::HarmlessPoison)) {
    case Judgement::Above:
        return "Poison: " + without + "adaptation to poison is a part of the rise.";
    case Judgement::Below:
        return "Poison: " + without + "poison limits the rise.";
    case Judgement::NotShown:
    case Judgement::CannotBeShown:
        break;
    }
    return "Poison: " + without + "an effect of poison on the rise is not shown.";
}

} // namespace

std::string signed_text(double value, int decimals) {
    char text[64];
    std::snprintf(text, sizeof text, "%+.*f", decimals, value);
    const std::string shown = text;
    return shown.find_first_of("123456789") == std::string::npos ? shown.substr(1) : shown;
}

std::vector<std::string> verdict(double rise, const Interval& rise_interval, const std::vector<ControlResult>& results,
                                 int decimals) {
    EVOD_ASSERT(results.size() == std::size(all_controls));
    const Sentences sentences{results, decimals};
    return {sentences.answer(rise, rise_interval), sentences.mutation_sentence(rise), sentences.poison_sentence(rise)};
}

} // namespace evod::experiments
