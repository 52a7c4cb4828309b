#include "server/experiments/comparison.h"

#include "server/base/assert.h"
#include "server/base/inline_executor.h"
#include "server/experiments/trials.h"
#include "server/simulation/world.h"

#include <algorithm>
#include <mutex>

namespace evod::experiments {
namespace {

GenerationFitness fitness_of(const simulation::GenerationRows& islands) {
    GenerationFitness all{.mean = 0, .best = islands.front().fitness_best, .organism_count = 0, .alive_count = 0};
    double sum = 0;
    for (const simulation::GenerationStatistics& island : islands) {
        sum += island.fitness_mean * island.organism_count;
        all.best = std::max(all.best, island.fitness_best);
        all.organism_count += island.organism_count;
        all.alive_count += island.alive_count;
    }
    all.mean = sum / static_cast<double>(all.organism_count);
    return all;
}

} // namespace

double rise_of(const Course& course) {
    EVOD_ASSERT(!course.empty());
    return course.back().mean - course.front().mean;
}

std::vector<SpeciesOfInterval> species_of(const Course& course) {
    std::vector<SpeciesOfInterval> species;
    for (const GenerationFitness& interval : course) {
        species.push_back(interval.species);
    }
    return species;
}

double outcome_of(const Course& course) {
    EVOD_ASSERT(!course.empty());
    const bool has_births = course.front().species[0].has_come;
    return has_births ? static_cast<double>(intervals_lived(species_of(course))) : rise_of(course);
}

std::optional<std::vector<std::vector<Course>>> run_arms(std::span<const Arm> arms, const RunsWanted& wanted) {
    EVOD_ASSERT(!arms.empty());
    const std::size_t generations = arms.front().parameters.generation_limit;
    for (const Arm& arm : arms) {
        EVOD_ASSERT(parameters::validate(arm.parameters).empty());
        EVOD_ASSERT(arm.parameters.generation_limit == generations);
    }
    std::vector<std::vector<Course>> courses(arms.size(), std::vector<Course>(wanted.replicates));
    const std::size_t trials = arms.size() * wanted.replicates;
    std::mutex progress_mutex;
    std::size_t generations_done = 0, trials_done = 0;
    for_each_trial(
        trials, wanted.jobs,
        [&](std::size_t trial) {
            // The threads run all arms of a replicate before the next replicate, so that all arms make equal progress.
            const std::size_t arm = trial % arms.size(), replicate = trial / arms.size();
            Course& course = courses[arm][replicate];
            simulation::World world{arms[arm].parameters,
                                    replicate_seed(wanted.seed, static_cast<std::uint32_t>(replicate)),
                                    {},
                                    arms[arm].schedule};
            base::InlineExecutor executor;
            while (world.outcome() == evolution::Outcome::Running && !wanted.stopped()) {
                world.advance_tick(executor);
                world.take_events();
                if (!world.generation_over()) {
                    continue;
                }
                const simulation::GenerationRows& rows = world.history().back();
                GenerationFitness generation = fitness_of(rows);
                if (parameters::has_births(arms[arm].parameters)) {
                    const std::vector<simulation::GenerationStatistics>& islands = rows;
                    generation.species =
                        species_of(islands, course.empty() ? SpeciesOfInterval{} : course.back().species);
                }
                course.push_back(generation);
                const bool is_over = world.outcome() != evolution::Outcome::Running;
                const std::scoped_lock lock{progress_mutex};
                trials_done += is_over ? 1 : 0;
                generations_done += is_over ? generations + 1 - course.size() : 1;
                wanted.progress(static_cast<double>(generations_done) / static_cast<double>(trials * generations));
            }
        },
        wanted.stopped);
    if (trials_done < trials) {
        return std::nullopt;
    }
    return courses;
}

std::vector<Finding> find_differences(std::span<const std::vector<Course>> courses, base::Seed seed) {
    EVOD_ASSERT(courses.size() >= 2);
    std::vector<Finding> findings;
    std::vector<double> p;
    for (const std::vector<Course>& other : courses.subspan(1)) {
        Finding finding;
        for (std::size_t replicate = 0; replicate < other.size(); ++replicate) {
            finding.differences.push_back(outcome_of(courses[0][replicate]) - outcome_of(other[replicate]));
        }
        finding.mean = mean_of(finding.differences);
        finding.interval = student_interval(finding.differences);
        finding.effect_size = hedges_g(finding.differences);
        finding.p = sign_flip_p(finding.differences, seed);
        p.push_back(finding.p);
        findings.push_back(std::move(finding));
    }
    const std::vector<double> adjusted = holm(p);
    for (std::size_t i = 0; i < findings.size(); ++i) {
        findings[i].adjusted_p = adjusted[i];
    }
    return findings;
}

Judgement judge(const Finding& finding, std::size_t tests) {
    if (finding.adjusted_p < significance) {
        return finding.mean > 0 ? Judgement::Above : Judgement::Below;
    }
    // Holm's adjustment multiplies a p-value by at most the number of tests.
    return least_sign_flip_p(finding.differences.size()) * static_cast<double>(tests) >= significance
               ? Judgement::CannotBeShown
               : Judgement::NotShown;
}

} // namespace evod::experiments
