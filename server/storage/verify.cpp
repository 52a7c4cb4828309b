#include "server/storage/verify.h"

#include "server/base/inline_executor.h"
#include "server/protocol/refusals.h"
#include "server/storage/rerun.h"

#include <algorithm>
#include <atomic>
#include <span>
#include <utility>
#include <vector>

namespace evod::storage {
namespace {

using base::Result;
using evolution::NextGeneration;
using simulation::World;

// ---- Two records of the same thing -------------------------------------------------------------------------------

/// What differs between them.
struct Mismatch {
    std::string part, stored, simulated;
};
using Found = std::optional<Mismatch>;

std::string text_of(double value) {
    return protocol::number_text(value + 0.0); // SQLite keeps −0 as 0
}
std::string text_of(std::uint64_t value) {
    return std::to_string(value);
}
std::string text_of(std::uint32_t value) {
    return std::to_string(value);
}
std::string text_of(bool value) {
    return value ? "true" : "false";
}
std::string text_of(simulation::CauseOfDeath cause) {
    return std::string{name_of(cause)};
}
std::string text_of(const evolution::Parents& parents) {
    return std::to_string(parents.first) + " and " + std::to_string(parents.second);
}
std::string text_of(const base::StateHash& hash) {
    return to_text(hash);
}

template <class T>
Found compare(const std::string& part, const T& stored, const T& simulated) {
    if (stored == simulated)
        return std::nullopt;
    return Mismatch{part, text_of(stored), text_of(simulated)};
}

/// of_island  " on island 3"
/// name       "the fitness"
template <class T>
Found compare_organisms(const char* name, const std::string& of_island, std::span<const T> stored,
                        std::span<const T> simulated) {
    if (stored.size() != simulated.size())
        return compare(std::string{name} + ": the number of organisms" + of_island, stored.size(), simulated.size());
    const auto [one, other] = std::ranges::mismatch(stored, simulated);
    if (one == stored.end())
        return std::nullopt;
    return compare(std::string{name} + " of organism " + std::to_string(one - stored.begin()) + of_island, *one,
                   *other);
}

Found compare(const std::string& which, const simulation::Parameters& stored, const simulation::Parameters& simulated) {
    for (const simulation::ParameterDescription& parameter : simulation::parameter_registry())
        if (const auto one = parameter.get(stored), other = parameter.get(simulated); one != other)
            return Mismatch{"the parameter " + std::string{parameter.name} + ", " + which, simulation::to_text(one),
                            simulation::to_text(other)};
    return std::nullopt;
}

Found compare(const std::string& of_island, const NextGeneration& stored, const NextGeneration& simulated) {
    const auto genes_of = [](const NextGeneration& born) {
        return std::span<const float>{born.genes.data(), static_cast<std::size_t>(born.genes.size())};
    };
    const auto stored_genes = genes_of(stored), simulated_genes = genes_of(simulated);
    if (stored_genes.size() != simulated_genes.size())
        return compare("the number of organisms" + of_island, static_cast<std::uint64_t>(stored.genes.cols()),
                       static_cast<std::uint64_t>(simulated.genes.cols()));
    if (const auto [one, other] = std::ranges::mismatch(stored_genes, simulated_genes); one != stored_genes.end()) {
        const auto place = static_cast<std::size_t>(one - stored_genes.begin());
        return compare("the chromosomes: gene " + std::string{evolution::gene_names[place % evolution::gene_count]} +
                           " of organism " + std::to_string(place / evolution::gene_count) + of_island,
                       double{*one}, double{*other});
    }
    if (auto found = compare_organisms<evolution::Parents>("the parents", of_island, stored.parents, simulated.parents))
        return found;
    if (auto found = compare("the number of the elite" + of_island, stored.elite_count, simulated.elite_count))
        return found;
    if (auto found = compare("the number of survivors" + of_island, stored.survivor_count, simulated.survivor_count))
        return found;
    return compare("the number of genes put onto their bounds" + of_island, stored.clamped_count,
                   simulated.clamped_count);
}

Found compare(const GenerationBegun& stored, const GenerationBegun& simulated) {
    const simulation::Opening& one = stored.opening;
    const simulation::Opening& other = simulated.opening;
    if (auto found = compare("the first tick", one.moment.tick, other.moment.tick))
        return found;
    if (auto found = compare("the simulated seconds", one.moment.simulated_s, other.moment.simulated_s))
        return found;
    if (auto found = compare("as it held", one.parameters.active, other.parameters.active))
        return found;
    if (auto found = compare("as it was asked for", one.parameters.requested, other.parameters.requested))
        return found;
    // A run that begins by a reset goes on counting revisions.
    if (one.moment.generation > 1)
        if (auto found = compare("the revision of the parameters", one.parameters.revision, other.parameters.revision))
            return found;
    const evolution::Progress &before = one.progress, &also = other.progress;
    if (auto found = compare("the progress: generations over", before.generations, also.generations))
        return found;
    if (auto found = compare("the progress: generations without improvement", before.stagnant, also.stagnant))
        return found;
    if (auto found = compare("the progress: the best fitness so far", before.best_fitness, also.best_fitness))
        return found;
    if (auto found = compare("the progress: the best fitness of the generation before", before.last_best_fitness,
                             also.last_best_fitness))
        return found;
    if (auto found = compare("the progress: whether everyone had died", before.last_died_out, also.last_died_out))
        return found;
    if (auto found = compare("the number of islands", stored.born.size(), simulated.born.size()))
        return found;
    for (std::size_t island = 0; island < stored.born.size(); ++island)
        if (auto found = compare(" on island " + std::to_string(island), stored.born[island], simulated.born[island]))
            return found;
    return std::nullopt;
}

Found compare(const std::string& of_island, const simulation::GenerationStatistics& stored,
              const simulation::GenerationStatistics& simulated) {
    std::vector<std::string> again;
    simulation::for_each_number(simulated,
                                [&](const std::string&, const auto& value) { again.push_back(text_of(value)); });
    Found found;
    auto simulated_text = again.begin();
    simulation::for_each_number(stored, [&](const std::string& name, const auto& value) {
        const std::string text = text_of(value); // exact
        if (!found && text != *simulated_text)
            found = Mismatch{"the statistics: " + name + of_island, text, *simulated_text};
        ++simulated_text;
    });
    return found;
}

Found compare(const GenerationEnded& stored, const GenerationEnded& simulated) {
    if (auto found = compare("the number of islands", stored.outcomes.size(), simulated.outcomes.size()))
        return found;
    for (std::size_t i = 0; i < stored.outcomes.size(); ++i) {
        const std::string of_island = " on island " + std::to_string(i);
        const IslandOutcome &one = stored.outcomes[i], &other = simulated.outcomes[i];
        if (auto found = compare_organisms<double>("the fitness", of_island, one.fitness, other.fitness))
            return found;
        if (auto found =
                compare_organisms<std::uint32_t>("the ticks lived", of_island, one.lived_ticks, other.lived_ticks))
            return found;
        if (auto found =
                compare_organisms<simulation::CauseOfDeath>("the cause of death", of_island, one.cause, other.cause))
            return found;
        if (auto found = compare(of_island, stored.statistics[i], simulated.statistics[i]))
            return found;
    }
    return std::nullopt;
}

/// Whether a generation can have begun so: the core relies on it. One that cannot is not what the generation before it
/// gives, and is told as that.
bool can_be_simulated(const GenerationBegun& begun) {
    const simulation::Parameters& parameters = begun.opening.parameters.active;
    const evolution::GeneBounds bounds = evolution::gene_bounds(parameters);
    return std::ranges::all_of(begun.born, [&](const NextGeneration& born) {
        return born.genes.cols() == parameters.population_size &&
               ((born.genes.colwise() - bounds.min >= 0) && (born.genes.colwise() - bounds.max <= 0)).all();
    });
}

// ---- One generation ----------------------------------------------------------------------------------------------

/// All that a file tells of a generation, and of those after it that have been taken out.
struct StoredGeneration {
    GenerationBegun begun;
    std::optional<GenerationEnded> ended;
    std::vector<HashLink> links;
    std::uint64_t last_tick = 0; // that the file tells of, of these generations
};

class GenerationCheck {
  public:
    /// next  the beginning of the next generation as it is stored; nullptr if none is.
    GenerationCheck(const RunFile& file, const StoredGeneration& stored, const GenerationBegun* next,
                    base::Executor& executor)
        : file_{file}
        , stored_{stored}
        , next_{next}
        , executor_{executor}
        , generation_{stored.begun.opening.moment.generation}
        , agrees_{generation_, stored.begun.opening.moment.tick} {}

    /// changes  the run's, up to the generation's last tick.
    /// told     called with the number of ticks since it was last called.
    Result<Verified> run(std::span<const ParameterChange> changes, base::FunctionRef<void(std::uint64_t)> told) {
        done_.generations = 1;
        if (generation_ == file_.identity().first_generation)
            check_beginning_of_run();
        if (done_.difference)
            return done_;
        if (!can_be_simulated(stored_.begun)) {
            differ(agrees_, {"the chromosomes", "out of their bounds", "within them"});
            return done_;
        }
        auto rerun = Rerun::from(file_, stored_.begun, changes, {}, executor_);
        if (!rerun)
            return rerun.error();
        const simulation::Moment began = rerun->world().moment(), &now = rerun->world().moment();
        for (;;) {
            check_hashes(*rerun, told);
            done_.ticks = now.tick - began.tick;
            done_.simulated_s = now.simulated_s - began.simulated_s;
            if (!done_.difference)
                check_end(rerun->world());
            if (done_.difference || !next_)
                return done_;
            if (now.generation + 1 == next_->opening.moment.generation)
                break;
            // The next one has been taken out of the file: its hashes, as far as they are held, and what came of it.
            if (!check_goes_on(rerun->world()))
                return done_;
            rerun->turn_over(executor_);
            ++done_.generations;
        }
        check_next(*rerun);
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

    void check_beginning_of_run() {
        const RunIdentity& identity = file_.identity();
        // What a fork began with, nothing in its file gives again but what was asked for.
        Found mismatch =
            identity.first_generation == 1
                ? compare(stored_.begun, beginning_of(World{identity.parameters, identity.seed}))
                : compare("as it was asked for", stored_.begun.opening.parameters.requested, identity.parameters);
        if (!mismatch)
            return;
        differ(agrees_, *std::move(mismatch));
        done_.difference->agrees.reset();
    }

    void check_hashes(Rerun& rerun, base::FunctionRef<void(std::uint64_t)> told) {
        const World& world = rerun.world();
        std::uint64_t told_tick = world.moment().tick;
        while (world.moment().tick < stored_.last_tick && !world.generation_over()) {
            rerun.advance_tick(executor_);
            const std::uint64_t tick = world.moment().tick;
            if (tick % ticks_per_link != 0)
                continue;
            told(tick - std::exchange(told_tick, tick));
            if (!file_.is_link_held(tick))
                continue;
            const StoredMoment now{world.moment().generation, tick};
            const bool held = link_ < stored_.links.size() && stored_.links[link_].tick == tick;
            if (!held)
                return differ(now, {"the state hash", "none", text_of(world.hash())});
            if (auto mismatch = compare("the state hash", stored_.links[link_].hash, world.hash()))
                return differ(now, *std::move(mismatch));
            agrees_ = now;
            agreeing_part_ = "the state hash";
            ++done_.hashes;
            ++link_;
        }
        told(world.moment().tick - told_tick);
    }

    void check_end(const World& world) {
        const StoredMoment now{world.moment().generation, world.moment().tick};
        const bool own = now.generation == generation_; // not one that has been taken out
        const bool ends = next_ || stored_.ended;
        const bool last = !next_ || now.generation + 1 == next_->opening.moment.generation;
        if (last && now.tick < stored_.last_tick)
            return differ(now, {"the generation's end", "later", "at this tick"});
        if (ends && !world.generation_over())
            return differ(now, {"the generation's end", "at this tick", "later"});
        if (!stored_.ended || !own)
            return;
        if (auto mismatch = compare(*stored_.ended, end_of(world)))
            return differ(now, *std::move(mismatch));
        agrees_ = now;
        agreeing_part_ = "the end of the generation";
    }

    bool check_goes_on(const World& world) {
        if (world.outcome() != evolution::Outcome::Running)
            differ({world.moment().generation + 1, world.moment().tick},
                   {"the run's end", "later", "before this generation"});
        return !done_.difference;
    }

    void check_next(Rerun& rerun) {
        if (!check_goes_on(rerun.world()))
            return;
        rerun.turn_over(executor_);
        const simulation::Moment& now = rerun.world().moment();
        if (auto mismatch = compare(*next_, beginning_of(rerun.world())))
            differ({now.generation, now.tick}, *std::move(mismatch));
    }

    const RunFile& file_;
    const StoredGeneration& stored_;
    const GenerationBegun* next_;
    base::Executor& executor_;
    const std::uint64_t generation_;
    StoredMoment agrees_; // the last moment that does
    const char* agreeing_part_ = "the beginning of the generation";
    std::size_t link_ = 0; // the next of stored_.links
    Verified done_;
};

// ---- All of them -------------------------------------------------------------------------------------------------

/// Reads a file's generations in order, each once.
class Reader {
  public:
    explicit Reader(RunFile& file) : file_{file}, contents_{file.contents()}, next_{file.identity().first_generation} {}

    const EndMark& contents() const { return contents_; }

    /// The next generations: at most `count`, and no more once there are `organisms` of them; none after the last.
    Result<std::vector<StoredGeneration>> read(std::size_t count, std::size_t organisms) {
        std::vector<StoredGeneration> generations;
        for (std::size_t held = 0; generations.size() < count && held < organisms && next_ <= contents_.generations;) {
            auto generation = read_next();
            if (!generation)
                return generation.error();
            for (const NextGeneration& born : generation->begun.born)
                held += static_cast<std::size_t>(born.genes.cols());
            generations.push_back(*std::move(generation));
        }
        return generations;
    }
    /// The beginning of the generation after those that were read last; nullptr if there is none.
    const GenerationBegun* following() const { return following_ ? &*following_ : nullptr; }

  private:
    Result<StoredGeneration> read_next() {
        StoredGeneration generation;
        if (!following_)
            if (auto begun = read_beginning(next_); !begun)
                return begun.error();
        generation.begun = std::move(*following_);
        following_.reset();
        auto ended = file_.outcome_of(next_);
        if (!ended)
            return ended.error();
        generation.ended = *std::move(ended);
        generation.last_tick = contents_.tick;
        next_ = file_.held_after(next_);
        if (next_ <= contents_.generations) {
            if (auto begun = read_beginning(next_); !begun)
                return begun.error();
            generation.last_tick = following_->opening.moment.tick;
        }
        auto links = file_.links(generation.begun.opening.moment.tick, generation.last_tick);
        if (!links)
            return links.error();
        generation.links = *std::move(links);
        return generation;
    }

    /// Into following_.
    Result<void> read_beginning(std::uint64_t generation) {
        auto begun = file_.beginning_of(generation);
        if (!begun)
            return begun.error();
        if (!*begun)
            return base::Refusal{.code = base::RefusalCode::DataLoss,
                                 .message =
                                     file_.path() + " is damaged: it holds no generation " + std::to_string(generation),
                                 .violations = {}};
        following_ = *std::move(begun);
        return {};
    }

    RunFile& file_;
    const EndMark contents_;
    std::uint64_t next_;                       // generation to be read
    std::optional<GenerationBegun> following_; // its beginning, once it has been read
};

void add(Verified& sum, const Verified& generation) {
    sum.generations += generation.generations;
    sum.ticks += generation.ticks;
    sum.hashes += generation.hashes;
    sum.simulated_s += generation.simulated_s;
    sum.difference = generation.difference;
}

} // namespace

Result<Verified> verify(RunFile& file, base::Executor& executor, base::FunctionRef<void(const VerifyProgress&)> told) {
    file.hold_still();
    if (auto sound = file.check(); !sound)
        return sound.error();
    if (auto refused = file.other_model())
        return *refused;
    const auto journal = file.journal();
    if (!journal)
        return journal.error();
    const auto changes = parameter_changes(file, *journal);
    if (!changes)
        return changes.error();

    // Enough for every thread to be busy though generations take different times, and no more than memory should hold.
    const std::size_t threads = executor.thread_count(), generations_at_once = 16 * threads;
    constexpr std::size_t organisms_at_once = 1'000'000;
    Reader reader{file};
    const std::uint64_t ticks_in_all = reader.contents().tick - std::min(reader.contents().tick, file.first_tick());
    std::atomic<std::uint64_t> ticks = 0;
    const auto count = [&](std::uint64_t more) {
        const std::uint64_t sum = ticks.fetch_add(more, std::memory_order_relaxed) + more;
        told({.ticks = sum, .ticks_in_all = ticks_in_all});
    };

    Verified verified;
    while (!verified.difference) {
        const auto generations = reader.read(generations_at_once, organisms_at_once);
        if (!generations)
            return generations.error();
        if (generations->empty())
            break;
        std::vector<Result<Verified>> results(generations->size(), Result<Verified>{Verified{}});
        const auto check = [&](std::size_t i, base::Executor& within) {
            const StoredGeneration& generation = (*generations)[i];
            const auto later = std::ranges::upper_bound(*changes, generation.last_tick, {}, &ParameterChange::tick);
            const GenerationBegun* next =
                i + 1 < generations->size() ? &(*generations)[i + 1].begun : reader.following();
            results[i] = GenerationCheck{file, generation, next, within}.run({changes->begin(), later}, count);
        };
        if (generations->size() >= threads) {
            executor.parallel_for(generations->size(), 1, [&](base::Range range) {
                base::InlineExecutor alone;
                for (std::size_t i = range.begin; i < range.end; ++i)
                    check(i, alone);
            });
        } else {
            for (std::size_t i = 0; i < generations->size(); ++i)
                check(i, executor);
        }
        for (const Result<Verified>& result : results) {
            if (!result)
                return result.error();
            add(verified, *result);
            if (verified.difference)
                break;
        }
    }
    return verified;
}

} // namespace evod::storage
