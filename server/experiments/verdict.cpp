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
    Sentences(const std::vector<Weighed>& weighed, int decimals) : weighed_{weighed}, decimals_{decimals} {
        tests_ = static_cast<std::size_t>(
            std::ranges::count_if(weighed, [](const Weighed& w) { return w.finding.has_value(); }));
    }

    std::string text(double value) const { return signed_text(value, decimals_); }
    const Weighed& of(ControlKind kind) const {
        return *std::ranges::find(weighed_, kind, [](const Weighed& w) { return w.control.kind; });
    }
    Judgement judgement(ControlKind kind) const { return judge(*of(kind).finding, tests_); }

    std::string answer(double rise, const Interval& interval) const;
    std::string of_mutation(double rise) const;
    std::string of_poison(double rise) const;

  private:
    /// "+121.3 above random selection (adjusted p = 7.6e-06)"
    std::string difference(ControlKind kind, const char* name) const {
        const Finding& finding = *of(kind).finding;
        return text(finding.mean) + " against " + name + " (" + p_text(finding) + ")";
    }

    const std::vector<Weighed>& weighed_;
    int decimals_;
    std::size_t tests_ = 0;
};

std::string Sentences::answer(double rise, const Interval& interval) const {
    const std::string question = "Did evolution do it? ";
    for (const ControlKind kind : {ControlKind::RandomSelection, ControlKind::ShuffledFitness}) {
        if (const std::string& why = of(kind).control.cannot_differ; !why.empty()) {
            return question + "No: " + why + ", so nothing is selected for what it does.";
        }
    }
    const Judgement judgements[] = {judgement(ControlKind::RandomSelection), judgement(ControlKind::ShuffledFitness)};
    const std::string differences = difference(ControlKind::RandomSelection, "random selection") + ", " +
                                    difference(ControlKind::ShuffledFitness, "shuffled fitness");
    const auto any = [&](Judgement judgement) { return std::ranges::count(judgements, judgement) > 0; };
    if (any(Judgement::Below)) {
        return question + "No: selection keeps the fitness below what it would be: " + differences + ".";
    }
    if (any(Judgement::CannotBeShown)) {
        return question +
               "That cannot be told with so few replicates: no difference, however large, has a p-value below " +
               "0.05 after the adjustment. Give more.";
    }
    if (any(Judgement::NotShown)) {
        return question + "That is not shown: " + differences + "; it takes both below 0.05.";
    }
    // The pressure might only have kept it from falling.
    const std::string how = interval.low > 0 ? "Yes: the mean fitness rose by " + text(rise).substr(1) +
                                                   ", and selection for fitness is why: "
                                             : "Yes, but the mean fitness is not shown to have risen (" + text(rise) +
                                                   "): selection for fitness made the difference, ";
    return question + how + differences + ".";
}

std::string Sentences::of_mutation(double rise) const {
    const Weighed& weighed = of(ControlKind::MutationOff);
    if (!weighed.finding) {
        return "Mutation: " + weighed.control.cannot_differ +
               "; what is selected is the variety of the first generation.";
    }
    const std::string without =
        "with mutation off the rise is " + text(rise - weighed.finding->mean) + " (" + p_text(*weighed.finding) + "): ";
    switch (judgement(ControlKind::MutationOff)) {
    case Judgement::Above:
        return "Mutation: " + without + "new variety adds to what the first generation brought.";
    case Judgement::Below:
        return "Mutation: " + without + "it costs more than it brings in so many generations.";
    case Judgement::NotShown:
    case Judgement::CannotBeShown:
        break;
    }
    return "Mutation: " + without + "that new variety matters is not shown.";
}

std::string Sentences::of_poison(double rise) const {
    const Weighed& weighed = of(ControlKind::HarmlessPoison);
    if (!weighed.finding) {
        return "Poison: " + weighed.control.cannot_differ + ".";
    }
    const std::string without = "were it harmless, the rise would be " + text(rise - weighed.finding->mean) + " (" +
                                p_text(*weighed.finding) + "): ";
    switch (judgement(ControlKind::HarmlessPoison)) {
    case Judgement::Above:
        return "Poison: " + without + "a part of the rise is getting on with it.";
    case Judgement::Below:
        return "Poison: " + without + "it keeps the fitness from rising further.";
    case Judgement::NotShown:
    case Judgement::CannotBeShown:
        break;
    }
    return "Poison: " + without + "that the rise depends on it is not shown.";
}

} // namespace

std::string signed_text(double value, int decimals) {
    char text[64];
    std::snprintf(text, sizeof text, "%+.*f", decimals, value);
    const std::string shown = text;
    return shown.find_first_of("123456789") == std::string::npos ? shown.substr(1) : shown;
}

std::vector<std::string> verdict(double rise, const Interval& rise_interval, const std::vector<Weighed>& weighed,
                                 int decimals) {
    EVOD_ASSERT(weighed.size() == std::size(all_controls));
    const Sentences sentences{weighed, decimals};
    return {sentences.answer(rise, rise_interval), sentences.of_mutation(rise), sentences.of_poison(rise)};
}

} // namespace evod::experiments
