#include "server/replay/verify.h"

#include "server/base/inline_executor.h"
#include "server/replay/columns.h"
#include "server/replay/mismatch.h"
#include "server/replay/rerun.h"
#include "server/run_file/check.h"
#include "server/run_file/checkpoint.h"

#include <algorithm>
#include <atomic>
#include <span>
#include <utility>
#include <vector>

namespace evod::replay {
namespace {

using base::Result;
using evolution::NextGeneration;
using simulation::World;

/// The stored records of a generation. `born` and `outcomes` are empty if the generation is not retained. `outcomes`
/// and `statistics` are empty if it has not ended.
struct StoredGeneration {
    simulation::Opening opening;
    std::vector<NextGeneration> born;
    simulation::Founders founders; // empty: unknown
    std::vector<simulation::IslandOpening> openings;
    std::vector<run_file::IslandOutcome> outcomes;
    std::vector<simulation::GenerationStatistics> statistics;
    std::vector<run_file::HashRecord> hashes;
    std::vector<run_file::StoredCheckpoint> checkpoints;
    std::uint64_t last_tick = 0; // last tick of this generation in the file
};

/// A retained generation and all following generations up to the next retained one.
using Stretch = std::vector<StoredGeneration>;

/// Whether a stored beginning is valid, which the core assumes. An invalid beginning differs from the result of the
/// previous generation and is reported as that difference. Organisms that live on may have genes outside the present
/// bounds; reading the file has checked them.
bool can_be_simulated(const StoredGeneration& generation) {
    const parameters::Parameters& parameters = generation.opening.parameters.active;
    const evolution::GeneBounds bounds = evolution::gene_bounds(parameters);
    return std::ranges::all_of(generation.born, [&](const NextGeneration& born) {
        return born.genes.rows() == bounds.min.rows() &&
               (!generation.openings.empty() ||
                (born.genes.cols() == Eigen::Index{parameters.population_size} + born.predator_count &&
                 ((born.genes.colwise() - bounds.min >= 0) && (born.genes.colwise() - bounds.max <= 0)).all()));
    });
}

class StretchCheck {
  public:
    /// following  the first generation after the stretch; nullptr if there is none.
    StretchCheck(const run_file::RunFile& file, const Stretch& stretch, const StoredGeneration* following,
                 base::Executor& executor)
        : file_{file}, stretch_{stretch}, following_{following}, executor_{executor} {}

    /// changes   all changes of the run up to the last tick of the stretch.
    /// progress  called with the number of ticks since the previous call.
    Result<Verified> run(std::span<const WorldChange> changes, base::FunctionRef<void(std::uint64_t)> progress) {
        const StoredGeneration& first = stretch_.front();
        agrees_with_beginning_of(first);
        if (first.opening.moment.generation == file_.identity().first_generation) {
            check_beginning_of_run();
        }
        if (!done_.difference && !can_be_simulated(first)) {
            differ(agrees_, {"the chromosomes", "outside their bounds", "within their bounds"});
        }
        if (done_.difference) {
            return done_;
        }
        auto rerun = Rerun::from(
            file_,
            {.opening = first.opening, .born = first.born, .founders = first.founders, .openings = first.openings},
            beginning(), changes, {}, executor_);
        if (!rerun) {
            return rerun.error();
        }
        const double began_s = rerun->world().moment().simulated_s;
        const std::uint64_t began_tick = rerun->world().moment().tick;
        for (std::size_t i = 0; i < stretch_.size() && !done_.difference && !rerun->changes().fault(); ++i) {
            check_generation(*rerun, stretch_[i], i + 1 < stretch_.size() ? &stretch_[i + 1] : following_, progress);
        }
        if (const auto& fault = rerun->changes().fault()) {
            return *fault;
        }
        done_.ticks = rerun->world().moment().tick - began_tick;
        done_.simulated_s = rerun->world().moment().simulated_s - began_s;
        return done_;
    }

  private:
    void differ(const StoredMoment& moment, Mismatch mismatch) {
        done_.difference = Difference{.agrees = agrees_,
                                      .agreeing_part = agreeing_part_,
                                      .differs = moment,
                                      .part = std::move(mismatch.part),
                                      .stored = std::move(mismatch.stored),
                                      .simulated = std::move(mismatch.simulated)};
    }
    /// Records a difference, if there is one. Returns whether there was none.
    bool same(const StoredMoment& moment, std::optional<Mismatch> mismatch) {
        if (mismatch) {
            differ(moment, *std::move(mismatch));
        }
        return !mismatch;
    }
    bool check_births(const StoredMoment& moment, const StoredGeneration& stored,
                      const run_file::GenerationBegun& simulated) {
        return same(moment, compare(stored.born, simulated.born, gene_names_)) &&
               same(moment, compare(stored.openings, simulated.openings)) &&
               (stored.founders.empty() || same(moment, compare(stored.founders, simulated.founders)));
    }
    void agrees_with_beginning_of(const StoredGeneration& generation) {
        agrees_ = {generation.opening.moment.generation, generation.opening.moment.tick};
        agreeing_part_ = "the beginning of the generation";
    }

    /// The checkpoint with which the run begins, if it begins with one in the first generation of the stretch;
    /// otherwise nullptr.
    const run_file::StoredCheckpoint* beginning() const {
        const StoredGeneration& first = stretch_.front();
        const bool has_one = first.opening.moment.generation == file_.identity().first_generation &&
                             !first.checkpoints.empty() &&
                             first.checkpoints.front().moment.tick == file_.identity().first_tick;
        return has_one ? &first.checkpoints.front() : nullptr;
    }

    void check_beginning_of_run() {
        const run_file::RunIdentity& identity = file_.identity();
        const StoredGeneration& first = stretch_.front();
        if (!identity.forked_from) {
            const World world{identity.parameters, identity.seed, identity.first_population, identity.schedule};
            const run_file::GenerationBegun begun = run_file::beginning_of(world);
            (void)(same(agrees_, compare(first.opening, begun.opening)) && check_births(agrees_, first, begun));
        } else {
            // The file of a fork does not contain its origin, so only the requested parameters of the beginning can be
            // checked.
            const run_file::StoredCheckpoint* within = beginning();
            const parameters::ParameterSet& set = within ? within->parameters : first.opening.parameters;
            (void)same(agrees_, compare_requested(set.requested, identity.requested_parameters()));
        }
        if (done_.difference) {
            done_.difference->agrees.reset();
        }
    }

    void check_generation(Rerun& rerun, const StoredGeneration& stored, const StoredGeneration* next,
                          base::FunctionRef<void(std::uint64_t)> progress) {
        ++done_.generations;
        agrees_with_beginning_of(stored);
        check_hashes(rerun, stored, progress);
        if (!done_.difference) {
            check_end(rerun.world(), stored, next != nullptr);
        }
        if (!done_.difference && next != nullptr) {
            check_next(rerun, *next);
        }
    }

    /// Whether the file contains the tick only because a generation begins before it. An
    /// earlier `evod run` that was killed may have stored the beginning of a generation without its first tick.
    bool is_only_implied(const StoredGeneration& stored, std::uint64_t tick) const {
        return following_ == nullptr && &stored == &stretch_.back() && stored.statistics.empty() &&
               tick == stored.last_tick && tick == stored.opening.moment.tick + 1;
    }

    void check_hashes(Rerun& rerun, const StoredGeneration& stored, base::FunctionRef<void(std::uint64_t)> progress) {
        const World& world = rerun.world();
        auto hash = stored.hashes.begin();
        auto checkpoint = std::ranges::upper_bound(stored.checkpoints, world.moment().tick, {},
                                                   [](const run_file::StoredCheckpoint& at) { return at.moment.tick; });
        std::uint64_t progress_tick = world.moment().tick;
        while (world.moment().tick < stored.last_tick && !world.generation_over() && !rerun.changes().fault()) {
            if (checkpoint != stored.checkpoints.end() && checkpoint->moment.tick == world.moment().tick + 1) {
                rerun.advance_tick(executor_, checkpoint->journal_entries);
                if (!check_checkpoint(world, *checkpoint++)) {
                    return;
                }
                rerun.apply_changes();
            } else {
                rerun.advance_tick(executor_);
            }
            const StoredMoment now{world.moment().generation, world.moment().tick};
            if (now.tick % run_file::ticks_per_hash != 0) {
                continue;
            }
            progress(now.tick - std::exchange(progress_tick, now.tick));
            if (!file_.retention().is_hash_retained(now.tick)) {
                continue;
            }
            if (hash == stored.hashes.end() && is_only_implied(stored, now.tick)) {
                return;
            }
            if (hash == stored.hashes.end() || hash->tick != now.tick) {
                return differ(now, {"the state hash", "none", to_text(rerun.hash_of_tick())});
            }
            if (!same(now, compare(hash->hash, rerun.hash_of_tick()))) {
                return;
            }
            agrees_ = now;
            agreeing_part_ = "the state hash";
            ++done_.hashes;
            ++hash;
        }
        progress(world.moment().tick - progress_tick);
    }

    /// Compares the world with a checkpoint, and restores a world from it. Returns whether all are equal.
    bool check_checkpoint(const World& world, const run_file::StoredCheckpoint& stored) {
        const StoredMoment now{world.moment().generation, world.moment().tick};
        simulation::WorldState state{
            .moment = stored.moment, .parameters = stored.parameters, .islands = {}, .ended = {}};
        if (const auto unpacked = run_file::unpack(stored.state, world.shapes(), state); !unpacked) {
            return same(now, Mismatch{"the checkpoint", unpacked.error().message, "a state of this world"});
        }
        std::optional<Mismatch> found = compare(state, world.state(executor_));
        if (found) {
            found->part = "the checkpoint: " + found->part;
        }
        if (!same(now, found ? std::move(found) : compare(stored.hash, world.hash()))) {
            return false;
        }
        World restored = world.at_its_opening(executor_); // as a restart does
        if (const auto done = restored.restore(state, executor_); !done) {
            return same(now, Mismatch{"the checkpoint", done.error().message, "a state that can be restored"});
        }
        if (!same(now, compare(stored.hash, restored.hash()))) {
            done_.difference->part = "the state hash of the world that was restored from the checkpoint";
            return false;
        }
        agrees_ = now;
        agreeing_part_ = "the checkpoint";
        ++done_.checkpoints;
        return true;
    }

    void check_end(const World& world, const StoredGeneration& stored, bool goes_on) {
        const StoredMoment now{world.moment().generation, world.moment().tick};
        const bool ended = !stored.statistics.empty();
        if (now.tick < stored.last_tick) {
            return differ(now, {"the generation's end", "later", "at this tick"});
        }
        if ((ended || goes_on) && world.awaits_fitness()) {
            return differ(now, {"the fitness from clients", "not complete in the journal", "needed here"});
        }
        if ((ended || goes_on) && !world.generation_over()) {
            return differ(now, {"the generation's end", "at this tick", "later"});
        }
        if (!ended) {
            return;
        }
        const run_file::GenerationEnded again = run_file::end_of(world);
        if (!stored.outcomes.empty() && !same(now, compare(stored.outcomes, again.outcomes))) {
            return;
        }
        if (!same(now, compare(stored.statistics, again.statistics, gene_names_))) {
            return;
        }
        agrees_ = now;
        agreeing_part_ = "the end of the generation";
    }

    void check_next(Rerun& rerun, const StoredGeneration& next) {
        const World& world = rerun.world();
        const StoredMoment moment{world.moment().generation + 1, world.moment().tick};
        if (world.outcome() != evolution::Outcome::Running) {
            return differ(moment, {"the run's end", "later", "before this generation"});
        }
        rerun.breed_next_generation(executor_);
        const run_file::GenerationBegun again = run_file::beginning_of(world);
        if (same(moment, compare(next.opening, again.opening)) && !next.born.empty()) {
            (void)check_births(moment, next, again);
        }
    }

    const run_file::RunFile& file_;
    const std::vector<std::string> gene_names_ = gene_names_of(file_.identity().parameters);
    const Stretch& stretch_;
    const StoredGeneration* following_;
    base::Executor& executor_;
    StoredMoment agrees_; // the last moment without a difference
    const char* agreeing_part_ = "";
    Verified done_;
};

/// Reads the generations of a file once, in order.
class Reader {
  public:
    explicit Reader(run_file::RunFile& file)
        : file_{file}, contents_{file.contents()}, next_{file.identity().first_generation} {}

    const run_file::EndMark& contents() const { return contents_; }

    /// Reads the next stretches: at most `count`, and no further ones once they have `organisms` organisms. Returns an
    /// empty vector after the last stretch.
    Result<std::vector<Stretch>> read(std::size_t count, std::size_t organisms) {
        if (!following_ && next_ <= contents_.generations) {
            if (auto read = read_following(); !read) {
                return read.error();
            }
        }
        std::vector<Stretch> stretches;
        for (std::size_t held = 0; following_ && stretches.size() < count && held < organisms;) {
            for (const NextGeneration& born : following_->born) {
                held += static_cast<std::size_t>(born.genes.cols());
            }
            Stretch& stretch = stretches.emplace_back();
            do {
                stretch.push_back(*std::move(following_));
                if (auto read = read_following(); !read) {
                    return read.error();
                }
                if (auto read = read_hashes(stretch.back()); !read) {
                    return read.error();
                }
            } while (following_ && following_->born.empty());
        }
        return stretches;
    }
    /// The generation that follows the last stretch that was read; nullptr if there is none.
    const StoredGeneration* following() const { return following_ ? &*following_ : nullptr; }

  private:
    Result<void> read_following() {
        following_.reset();
        if (next_ > contents_.generations) {
            return {};
        }
        const std::uint64_t number = next_++;
        // check() has verified that no record is missing.
        StoredGeneration& generation = following_.emplace();
        auto begun = file_.generations().beginning_of(number);
        if (!begun) {
            return begun.error();
        }
        if (*begun) {
            generation.opening = (*begun)->opening;
            generation.born = std::move((*begun)->born);
            generation.founders = std::move((*begun)->founders);
            generation.openings = std::move((*begun)->openings);
        } else {
            const auto opening = file_.generations().opening_of(number);
            if (!opening) {
                return opening.error();
            }
            generation.opening = opening->value();
        }
        auto ended = file_.generations().outcome_of(number);
        if (!ended) {
            return ended.error();
        }
        if (*ended) {
            generation.outcomes = std::move((*ended)->outcomes);
        }
        auto statistics = file_.generations().statistics_of(number);
        if (!statistics) {
            return statistics.error();
        }
        generation.statistics = *std::move(statistics);
        return {};
    }

    /// Reads the hashes and checkpoints of a generation. The next generation must have been read before.
    Result<void> read_hashes(StoredGeneration& generation) {
        generation.last_tick = following_ ? following_->opening.moment.tick : contents_.tick;
        // A fork may begin within a generation. The hash of its first tick is in the file of its origin.
        const std::uint64_t first_tick = std::max(generation.opening.moment.tick, file_.identity().first_tick);
        auto hashes = file_.hashes(first_tick, generation.last_tick);
        if (!hashes) {
            return hashes.error();
        }
        generation.hashes = *std::move(hashes);
        // A fork may begin with a checkpoint at the first tick of its first generation.
        const bool is_first = generation.opening.moment.generation == file_.identity().first_generation;
        auto checkpoints = file_.checkpoints().read(
            static_cast<std::int64_t>(generation.opening.moment.tick) - is_first, generation.last_tick);
        if (!checkpoints) {
            return checkpoints.error();
        }
        generation.checkpoints = *std::move(checkpoints);
        return {};
    }

    run_file::RunFile& file_;
    const run_file::EndMark contents_;
    std::uint64_t next_; // number of the next generation to read
    std::optional<StoredGeneration> following_;
};

void add(Verified& sum, const Verified& stretch) {
    sum.generations += stretch.generations;
    sum.ticks += stretch.ticks;
    sum.hashes += stretch.hashes;
    sum.checkpoints += stretch.checkpoints;
    sum.simulated_s += stretch.simulated_s;
    sum.difference = stretch.difference;
}

} // namespace

Result<Verified> verify(run_file::RunFile& file, base::Executor& executor,
                        base::FunctionRef<void(const VerifyProgress&)> progress) {
    if (auto held = file.pin_snapshot(); !held) {
        return held.error();
    }
    const std::uint64_t before = file.identity().first_generation - 1;
    const std::uint64_t generations = std::max(file.generations().last(), before) - before;
    const auto report_read = [&](std::uint64_t generation) {
        progress({.generations = generation - before - 1, .generations_in_all = generations});
    };
    if (auto sound = check(file, report_read); !sound) {
        return sound.error();
    }
    if (auto refused = file.other_model()) {
        return *refused;
    }
    const auto changes = world_changes(file);
    if (!changes) {
        return changes.error();
    }

    // verify() reads enough stretches to keep all threads busy although some take longer. A bound limits their memory.
    const std::size_t threads = executor.thread_count(), stretches_at_once = 16 * threads;
    constexpr std::size_t organisms_at_once = 1'000'000;
    Reader reader{file};
    const std::uint64_t ticks_in_all =
        reader.contents().tick - std::min(reader.contents().tick, file.identity().first_tick);
    std::atomic<std::uint64_t> ticks = 0;
    const auto count = [&](std::uint64_t more) {
        const std::uint64_t sum = ticks.fetch_add(more, std::memory_order_relaxed) + more;
        progress({.generations = generations,
                  .generations_in_all = generations,
                  .ticks = sum,
                  .ticks_in_all = ticks_in_all});
    };

    Verified verified;
    while (!verified.difference) {
        const auto stretches = reader.read(stretches_at_once, organisms_at_once);
        if (!stretches) {
            return stretches.error();
        }
        if (stretches->empty()) {
            break;
        }
        std::vector<Result<Verified>> results(stretches->size(), Result<Verified>{Verified{}});
        const auto check = [&](std::size_t i, base::Executor& within) {
            const Stretch& stretch = (*stretches)[i];
            const auto later = std::ranges::upper_bound(*changes, stretch.back().last_tick, {}, &WorldChange::tick);
            const StoredGeneration* following =
                i + 1 < stretches->size() ? &(*stretches)[i + 1].front() : reader.following();
            results[i] = StretchCheck{file, stretch, following, within}.run({changes->begin(), later}, count);
        };
        if (stretches->size() >= threads) {
            executor.parallel_for(stretches->size(), 1, [&](base::Range range) {
                base::InlineExecutor alone;
                for (std::size_t i = range.begin; i < range.end; ++i) {
                    check(i, alone);
                }
            });
        } else {
            for (std::size_t i = 0; i < stretches->size(); ++i) {
                check(i, executor);
            }
        }
        for (const Result<Verified>& result : results) {
            if (!result) {
                return result.error();
            }
            add(verified, *result);
            if (verified.difference) {
                break;
            }
        }
    }
    return verified;
}

} // namespace evod::replay
