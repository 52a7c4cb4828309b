#include "server/replay/generation_reader.h"

#include "server/replay/columns.h"
#include "server/replay/mismatch.h"

#include <utility>

namespace evod::replay {

using base::Refusal;
using base::Result;
using evolution::NextGeneration;

Result<void> expect_generation(run_file::RunFile& file, std::uint64_t generation) {
    const auto opening = file.generations().opening_of(generation);
    if (!opening) {
        return opening.error();
    }
    if (!*opening) {
        return Refusal{.code = base::RefusalCode::DataLoss,
                       .message = file.path() + " is damaged: it contains generation " +
                                  std::to_string(file.generations().last()) + ", but not generation " +
                                  std::to_string(generation),
                       .violations = {}};
    }
    return {};
}

Refusal GenerationReader::damaged(std::uint64_t generation, const std::string& what) const {
    return {.code = base::RefusalCode::DataLoss,
            .message = file_.path() + " is damaged: generation " + std::to_string(generation) + " " + what,
            .violations = {}};
}

Result<WholeGeneration> GenerationReader::read(std::uint64_t generation) {
    if (stop_()) {
        return cancelled_refusal();
    }
    auto whole = is_stored(file_, generation, needed_) ? read_stored(generation) : simulate(generation);
    if (!whole) {
        return whole;
    }
    if (has_births()) {
        if (auto added = add_born(generation, *whole); !added) {
            return added.error();
        }
    } else if (auto added = add_placed(generation, *whole); !added) {
        return added.error();
    }
    if (auto checked = check_outcome(generation, *whole); !checked) {
        return checked.error();
    }
    return whole;
}

Result<void> GenerationReader::check_outcome(std::uint64_t generation, const WholeGeneration& whole) {
    if (whole.ended) {
        bool matches = whole.ended->outcomes.size() == whole.begun.born.size();
        for (std::size_t i = 0; matches && i < whole.begun.born.size(); ++i) {
            const evolution::GeneMatrix& genes = whole.begun.born[i].genes;
            const run_file::IslandOutcome& outcome = whole.ended->outcomes[i];
            matches = outcome.fitness.size() == static_cast<std::size_t>(genes.cols()) &&
                      (outcome.repaired.empty() || outcome.repaired.size() == static_cast<std::size_t>(genes.size()));
        }
        if (!matches) {
            // Only a simulation finds the organisms that were placed in a fork's first generation before the fork.
            const bool inherits = file_.identity().forked_from && generation == file_.identity().first_generation;
            if (auto other = file_.other_model(); other && inherits) {
                return *std::move(other);
            }
            return damaged(generation, "has an outcome for another number of organisms");
        }
    }
    return {};
}

Result<void> GenerationReader::add_born(std::uint64_t generation, WholeGeneration& whole) const {
    std::vector<NextGeneration>& born = whole.begun.born;
    if (whole.births.empty()) { // it is stored
        for (const run_file::IslandOutcome& outcome : whole.ended->outcomes) {
            whole.births.push_back(outcome.births);
        }
        whole.births.resize(born.size());
        for (std::size_t island = 0; island < born.size(); ++island) {
            evolution::GeneMatrix& genes = born[island].genes;
            const Eigen::Index bred = genes.cols();
            genes.conservativeResize(Eigen::NoChange, bred + std::ssize(whole.births[island]));
            genes.rightCols(genes.cols() - bred).setZero();
        }
    }
    for (std::size_t island = 0; island < born.size(); ++island) {
        std::vector<std::uint32_t>& ticks = whole.placed.emplace_back();
        auto id = static_cast<std::uint32_t>(born[island].genes.cols() - std::ssize(whole.births[island]));
        for (const simulation::Birth& birth : whole.births[island]) {
            const bool is_placed = birth.parents == simulation::Island::no_parents;
            if (!is_placed && (birth.parents.first >= id || birth.parents.second >= id)) {
                return damaged(generation, "has parents that did not exist");
            }
            ticks.push_back(birth.tick);
            ++id;
        }
    }
    return {};
}

void GenerationReader::add_simulated(WholeGeneration& whole) {
    const simulation::WorldState state = rerun_->world().state(executor_);
    for (std::size_t island = 0; island < state.islands.size(); ++island) {
        std::vector<simulation::Birth>& births = whole.births.emplace_back();
        evolution::GeneMatrix& genes = whole.begun.born[island].genes;
        Eigen::Index id = genes.cols();
        genes.conservativeResize(Eigen::NoChange, id + std::ssize(state.islands[island].placed));
        for (const simulation::IslandState::Placed& organism : state.islands[island].placed) {
            std::ranges::copy(organism.genes, genes.col(id++).data());
            births.push_back({organism.tick, organism.parents});
        }
    }
}

Result<WholeGeneration> GenerationReader::read_stored(std::uint64_t generation) {
    auto begun = file_.generations().beginning_of(generation);
    if (!begun) {
        return begun.error();
    }
    auto ended = file_.generations().outcome_of(generation);
    if (!ended) {
        return ended.error();
    }
    if (!*begun) {
        return damaged(generation, "is missing");
    }
    return WholeGeneration{*std::move(*begun), *std::move(ended)};
}

Result<void> GenerationReader::read_changes() {
    if (!changes_) {
        auto changes = world_changes(file_, 0, stop_);
        if (!changes) {
            return changes.error();
        }
        changes_ = *std::move(changes);
    }
    return {};
}

Result<void> GenerationReader::add_placed(std::uint64_t generation, WholeGeneration& whole) {
    if (auto read = read_changes(); !read) {
        return read;
    }
    std::vector<NextGeneration>& born = whole.begun.born;
    whole.placed.resize(born.size());
    const auto add = [&](std::size_t island, evolution::ConstGenes genes, std::uint64_t tick) {
        evolution::GeneMatrix& matrix = born[island].genes;
        matrix.conservativeResize(Eigen::NoChange, matrix.cols() + 1);
        std::ranges::copy(genes, evolution::column(matrix, static_cast<std::uint32_t>(matrix.cols() - 1)).begin());
        whole.placed[island].push_back(static_cast<std::uint32_t>(tick));
    };
    const run_file::RunIdentity& identity = file_.identity();
    if (generation == identity.first_generation && identity.forked_from && !file_.other_model()) {
        // Organisms that were placed before the fork are in the checkpoint with which the fork begins.
        const auto fork = Rerun::begun_at(file_, generation, nullptr, {}, 0, executor_);
        if (!fork) {
            return fork.error();
        }
        for (const simulation::Island& island : fork->world().islands()) {
            for (std::uint32_t id = island.bred_count(); id < island.born().genes.cols(); ++id) {
                add(island.index(), evolution::column(island.born().genes, id), island.placed_tick(id));
            }
        }
    }
    // No command places anything between the end of a generation and the first tick of the next one.
    const std::uint64_t first_tick = whole.begun.opening.moment.tick;
    const std::uint64_t end_tick = whole.ended ? whole.ended->statistics.front().end_tick : ~std::uint64_t{0};
    for (const WorldChange& change : *changes_) {
        if (change.tick < first_tick || change.tick >= end_tick || !change.checked) {
            continue;
        }
        if (const auto* place = std::get_if<simulation::PlaceEntities>(&*change.checked)) {
            if (place->island >= born.size()) {
                return damaged(generation, "has no island on which entry " + std::to_string(change.entry) +
                                               " of the journal placed organisms");
            }
            for (const auto& organism : place->organisms) {
                if (organism.genes.size() != static_cast<std::size_t>(born[place->island].genes.rows())) {
                    return damaged(generation, "has another number of genes than an organism that entry " +
                                                   std::to_string(change.entry) + " of the journal placed");
                }
                add(place->island, organism.genes, change.tick - first_tick);
            }
        }
    }
    return {};
}

Result<WholeGeneration> GenerationReader::simulate(std::uint64_t generation) {
    if (auto advanced = advance_to_generation(generation); !advanced) {
        return advanced.error();
    }
    const simulation::World& world = rerun_->world();
    WholeGeneration whole{run_file::beginning_of(world), {}};
    const auto statistics = file_.generations().statistics_of(generation);
    if (!statistics) {
        return statistics.error();
    }
    const bool has_ended = !statistics->empty();
    if (!has_ended && !has_births()) {
        return whole;
    }
    const std::uint64_t last_tick = file_.last_tick();
    while (!world.generation_over() && (has_ended || world.moment().tick < last_tick)) {
        if (auto done = advance_tick(); !done) {
            return done.error();
        }
    }
    if (has_births()) {
        add_simulated(whole);
    }
    if (!has_ended) {
        return whole;
    }
    whole.ended = run_file::end_of(world);
    if (const auto mismatch =
            compare(*statistics, whole.ended->statistics, gene_names_of(file_.identity().parameters))) {
        return damaged(generation, "has other statistics when it is simulated again: " + mismatch->part + ": stored " +
                                       mismatch->stored + ", simulated again " + mismatch->simulated);
    }
    return whole;
}

Result<void> GenerationReader::advance_tick() {
    if (stop_()) {
        return cancelled_refusal();
    }
    rerun_->advance_tick(executor_);
    if (const auto& fault = rerun_->changes().fault()) {
        return *fault;
    }
    return {};
}

Result<void> GenerationReader::advance_to_generation(std::uint64_t generation) {
    const std::uint64_t retained = file_.retention().at_or_before(generation);
    if (!rerun_ || rerun_->world().moment().generation >= generation ||
        rerun_->world().moment().generation < retained) {
        if (auto refused = file_.other_model()) {
            return *refused;
        }
        if (auto read = read_changes(); !read) {
            return read;
        }
        auto rerun = Rerun::begun_at(file_, retained, nullptr, *changes_, 0, executor_);
        if (!rerun) {
            return rerun.error();
        }
        rerun_.emplace(*std::move(rerun));
    }
    while (rerun_->world().moment().generation < generation) {
        if (!rerun_->world().generation_over()) {
            if (auto done = advance_tick(); !done) {
                return done;
            }
        } else if (rerun_->world().outcome() == evolution::Outcome::Running) {
            rerun_->breed_next_generation(executor_);
        } else {
            return damaged(generation, "begins after the end of the run");
        }
    }
    return {};
}

} // namespace evod::replay
