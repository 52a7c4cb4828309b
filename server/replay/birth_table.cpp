#include "server/replay/birth_table.h"

#include "server/replay/generation_reader.h"
#include "server/replay/origins.h"

#include <map>
#include <optional>
#include <set>
#include <span>

namespace evod::replay {
namespace {

using base::Result;

/// What is known of an organism that lives.
struct Life {
    std::uint64_t generation; // of its birth, or the first one of the file
    std::size_t organism;     // its id in that interval
    simulation::Species species;
    std::int64_t born_tick;                    // of the run; before 0 if the run began with a later interval
    std::optional<evolution::Parents> parents; // their numbers
    std::uint32_t children;
};

class BirthTable {
  public:
    BirthTable(std::ostream& out, Table::Format format)
        : table_{out,
                 format,
                 {"generation", "island", "organism", "number", "species", "born_tick", "died_tick", "cause",
                  "parent_first_number", "parent_second_number", "children"}} {}

    /// Adds an interval of an island. The lives that it ends are written.
    ///
    /// follows  whether the interval that was added before is the previous one.
    void add(const WholeGeneration& whole, std::size_t island, bool follows);
    /// Writes the lives of all that were alive at the end of the last interval.
    void write_living() {
        for (std::size_t island = 0; island < living_.size(); ++island) {
            write_missing(island, "alive", {});
        }
    }
    bool can_write() const { return table_.can_write(); }

  private:
    using Living = std::map<std::uint32_t, Life>; // by number

    void write(std::size_t island, std::uint32_t number, const Life& life, std::optional<std::uint64_t> died_tick,
               std::string_view cause);
    /// Writes the lives that are not among `still`, and forgets them.
    void write_missing(std::size_t island, std::string_view cause, std::span<const std::uint32_t> still);

    Table table_;
    std::vector<Living> living_; // per island
};

void BirthTable::write(std::size_t island, std::uint32_t number, const Life& life,
                       std::optional<std::uint64_t> died_tick, std::string_view cause) {
    table_.number(life.generation).number(island).number(life.organism).number(number).text(species_name(life.species));
    table_.number(life.born_tick);
    died_tick ? table_.number(*died_tick) : table_.nothing();
    table_.text(cause);
    if (life.parents) {
        table_.number(life.parents->first).number(life.parents->second);
    } else {
        table_.nothing().nothing();
    }
    table_.number(life.children).end_row();
}

void BirthTable::write_missing(std::size_t island, std::string_view cause, std::span<const std::uint32_t> still) {
    const std::set<std::uint32_t> kept(still.begin(), still.end());
    std::erase_if(living_[island], [&](const auto& item) {
        const auto& [number, life] = item;
        if (!kept.contains(number)) {
            write(island, number, life, {}, cause);
        }
        return !kept.contains(number);
    });
}

void BirthTable::add(const WholeGeneration& whole, std::size_t island, bool follows) {
    const Origins origins = origins_of(whole, island);
    const simulation::Moment& begun = whole.begun.opening.moment;
    const simulation::IslandOpening* opening = whole.begun.openings.empty() ? nullptr : &whole.begun.openings[island];
    const std::uint32_t first_number = opening ? opening->next_number : origins.bred_count;
    const auto number_of = [&](std::size_t organism) {
        return organism >= origins.bred_count ? first_number + static_cast<std::uint32_t>(organism - origins.bred_count)
               : opening                      ? opening->numbers[organism]
                                              : static_cast<std::uint32_t>(organism);
    };
    living_.resize(whole.begun.born.size());
    if (opening) {
        write_missing(island, follows ? "replaced" : "unknown", opening->numbers); // a migrant has its place
    }
    Living& living = living_[island];
    for (std::size_t organism = 0; organism < origins.organism_count() && can_write(); ++organism) {
        const bool is_bred = organism < origins.bred_count;
        const std::uint32_t number = number_of(organism);
        const std::int64_t since = is_bred ? -std::int64_t{opening ? opening->age_ticks[organism] : 0}
                                           : whole.placed[island][organism - origins.bred_count];
        Life life{.generation = begun.generation,
                  .organism = organism,
                  .species = origins.species(organism),
                  .born_tick = static_cast<std::int64_t>(begun.tick) + since,
                  .parents = is_bred ? std::nullopt : origins.parents_of(organism),
                  .children = 0};
        if (life.parents) {
            life.parents = {number_of(life.parents->first), number_of(life.parents->second)};
        }
        Life& known = living.try_emplace(number, life).first->second;
        if (!whole.ended) {
            continue;
        }
        const run_file::IslandOutcome& outcome = whole.ended->outcomes[island];
        known.children = static_cast<std::uint32_t>(outcome.fitness[organism]);
        if (outcome.cause[organism] != simulation::CauseOfDeath::Alive) {
            const std::uint64_t from = begun.tick + (is_bred ? 0 : whole.placed[island][organism - origins.bred_count]);
            write(island, number, known, from + outcome.lived_ticks[organism],
                  run_file::name_of(outcome.cause[organism]));
            living.erase(number);
        }
    }
}

} // namespace

Result<void> write_births(const RunSource& run, std::ostream& out, Table::Format format) {
    run_file::RunFile& file = run.file;
    if (!parameters::has_births(file.identity().parameters)) {
        return refusal(base::RefusalCode::FailedPrecondition,
                       "the table births needs a world with births: its parameter reproduction is births");
    }
    BirthTable table{out, format};
    GenerationReader reader{file, run.executor, run.stop};
    const std::uint64_t last = file.generations().last();
    bool follows = true;
    for (std::uint64_t generation = file.identity().first_generation; generation <= last && out; ++generation) {
        if (run.stop()) {
            return cancelled_refusal();
        }
        if (!can_be_read(file, generation)) {
            if (auto begun = expect_generation(file, generation); !begun) {
                return begun;
            }
            follows = false;
            continue;
        }
        const auto whole = reader.read(generation);
        if (!whole) {
            return whole.error();
        }
        for (std::size_t island = 0; island < whole->begun.born.size(); ++island) {
            table.add(*whole, island, follows);
        }
        follows = true;
    }
    table.write_living();
    return {};
}

} // namespace evod::replay
