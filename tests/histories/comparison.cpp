#include "tests/histories/comparison.h"

#include "server/base/inline_executor.h"
#include "server/replay/mismatch.h"

#include <algorithm>
#include <span>
#include <vector>

namespace evod::histories {
namespace {

using simulation::Entry;
using simulation::World;
using Found = std::optional<std::string>;

template <class Number>
std::string text_of(const std::optional<Number>& number) {
    return number ? std::to_string(*number) : "none";
}

std::string text_of(const simulation::Moment& moment) {
    return "generation " + std::to_string(moment.generation) + ", tick " + std::to_string(moment.generation_tick) +
           " (of the run " + std::to_string(moment.tick) + ")";
}

std::string text_of(const simulation::RunControl& control) {
    return std::string{control.endless ? "endless " : ""} + "until_generation " + text_of(control.until_generation) +
           " until_tick " + text_of(control.until_tick) + (control.paused ? " paused" : "") +
           (control.leased ? " leased" : "") + " speed " + text_of(control.speed);
}

std::string text_of(std::span<const parameters::Assignment> assignments) {
    std::string text;
    for (const parameters::Assignment& assignment : assignments) {
        text += " " + assignment.name + "=" + parameters::to_text(assignment.value);
    }
    return text;
}

std::string text_of(const std::vector<parameters::PlannedChange>& planned) {
    std::string text;
    for (const parameters::PlannedChange& change : planned) {
        text += "[" + std::to_string(change.id) + " at generation " + text_of(change.at.generation) + ", tick " +
                text_of(change.at.tick) + " by " + to_text(change.by) + ":" + text_of(change.assignments) + "]";
    }
    return text;
}

std::string text_of(const std::deque<simulation::Change>& changes) {
    std::string text;
    for (const simulation::Change& change : changes) {
        text += "[generation " + std::to_string(change.generation) + " by " + to_text(change.by) + ":";
        for (const simulation::ChangedValue& value : change.values) {
            text +=
                " " + value.name + " " + parameters::to_text(value.before) + "->" + parameters::to_text(value.after);
        }
        text += "]";
    }
    return text;
}

std::string differing(const std::string& part, const std::string& got, const std::string& expected) {
    return part + ": " + got + ", expected " + expected;
}

Found compare_text(const std::string& part, const std::string& got, const std::string& expected) {
    return got == expected ? Found{} : differing(part, got, expected);
}

Found text_of(const std::optional<replay::Mismatch>& mismatch) {
    return mismatch ? Found{differing(mismatch->part, mismatch->stored, mismatch->simulated)} : Found{};
}

Found compare_parameters(const std::string& which, const parameters::Parameters& got,
                         const parameters::Parameters& expected) {
    const auto names = parameters::parameters_that_differ(got, expected);
    if (names.empty()) {
        return {};
    }
    const parameters::ParameterDescription& first = *names.front();
    return differing("the " + which + " value of " + std::string{first.name}, parameters::to_text(first.get(got)),
                     parameters::to_text(first.get(expected)));
}

Found compare_moment(const Entry& world, const Entry& twin) {
    const World &got = world.world, &expected = twin.world;
    const auto number = [](std::uint64_t value) { return std::to_string(value); };
    Found found = compare_text("the moment", text_of(got.moment()), text_of(expected.moment()));
    const auto then = [&](auto&& compare) { found = found ? std::move(found) : compare(); };
    then([&] {
        return compare_text("whether the generation is over", number(got.generation_over()),
                            number(expected.generation_over()));
    });
    then([&] {
        return compare_text("whether it awaits fitness", number(got.awaits_fitness()),
                            number(expected.awaits_fitness()));
    });
    then([&] { return compare_parameters("active", got.parameters().active, expected.parameters().active); });
    then([&] {
        return compare_parameters("requested", got.parameters().requested.values,
                                  expected.parameters().requested.values);
    });
    then([&] {
        return compare_text("the revision", number(got.parameters().revision), number(expected.parameters().revision));
    });
    then([&] { return compare_text("the planned changes", text_of(got.planned()), text_of(expected.planned())); });
    then([&] {
        return compare_text("the number of living organisms", number(got.alive_count()),
                            number(expected.alive_count()));
    });
    then([&] { return compare_text("the state hash", to_text(got.hash()), to_text(expected.hash())); });
    then([&] {
        return compare_text("the outcome", number(static_cast<std::uint64_t>(got.outcome())),
                            number(static_cast<std::uint64_t>(expected.outcome())));
    });
    then([&] { return compare_text("the run control", text_of(world.control), text_of(twin.control)); });
    return found;
}

Found compare_history(const World& got, const World& expected) {
    const auto size = [](const World& world) { return std::to_string(world.history().size()); };
    Found found = compare_text("the number of generations with statistics", size(got), size(expected));
    for (std::size_t i = 0; !found && i < got.history().size(); ++i) {
        found = text_of(
            replay::compare(std::vector<simulation::GenerationStatistics>(got.history()[i]), expected.history()[i]));
    }
    return found ? found
                 : compare_text("the changes of parameters", text_of(got.changes().all()),
                                text_of(expected.changes().all()));
}

} // namespace

Found difference_of(const Entry& world, const Entry& twin, Depth depth, base::Executor& executor) {
    Found found = compare_moment(world, twin);
    if (found || depth == Depth::Moment) {
        return found;
    }
    base::InlineExecutor here;
    found = compare_history(world.world, twin.world);
    found = found ? found : text_of(replay::compare(world.world.bred().islands, twin.world.bred().islands));
    found = found ? found : text_of(replay::compare(world.world.state(executor), twin.world.state(here)));
    found = found ? found
                  : compare_text("the seed", std::to_string(world.world.seed().value),
                                 std::to_string(twin.world.seed().value));
    const bool same_schedule = world.world.schedule() == twin.world.schedule();
    found = found ? found : compare_text("the schedule", same_schedule ? "the same" : "another", "the same");
    const bool same_population = simulation::same(world.world.first_population(), twin.world.first_population());
    return found ? found : compare_text("the first population", same_population ? "the same" : "another", "the same");
}

} // namespace evod::histories
