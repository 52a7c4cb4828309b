#include "server/run_file/retention.h"

#include "server/run_file/rows.h"
#include "server/run_file/schema.h"

#include <algorithm>
#include <string>
#include <vector>

namespace evod::run_file {

using base::Result;

Result<void> Retention::read() {
    TableReader<ThinnedTable> rules{database_.database, "1 ORDER BY number"};
    ThinnedTable::Row row;
    for (std::uint64_t number = 1; rules.next(row); ++number) {
        // Larger than any value that repeated doubling can reach.
        constexpr std::uint64_t keep_every_max = std::uint64_t{1} << 40;
        if (!rules.sound() || row.number != number || row.rule.keep_every == 0 ||
            row.rule.keep_every > keep_every_max) {
            return database_.damaged(row_text(ThinnedTable::name, number));
        }
        rule_ = row.rule;
    }
    return database_.unless_failed();
}

std::uint64_t Retention::last_generation() {
    return database_.natural("SELECT max(generation) FROM generation");
}

bool Retention::is_retained(std::uint64_t generation) {
    const std::uint64_t place = generation - identity_.first_generation;
    if (generation <= rule_.until_generation) {
        return place % rule_.keep_every == 0;
    }
    return place % keep_every_ == 0 || generation >= last_generation();
}

std::uint64_t Retention::at_or_before(std::uint64_t generation) {
    if (is_retained(generation)) {
        return generation;
    }
    const auto round_down = [&](std::uint64_t keep_every) {
        generation -= (generation - identity_.first_generation) % keep_every;
    };
    round_down(keep_every_);
    if (generation <= rule_.until_generation) {
        round_down(rule_.keep_every);
    }
    return generation;
}

std::uint64_t Retention::at_or_after(std::uint64_t generation) {
    const std::uint64_t first = identity_.first_generation, until = rule_.until_generation;
    const auto step_forward = [first](std::uint64_t from, std::uint64_t keep_every) {
        return first + (from - first + keep_every - 1) / keep_every * keep_every;
    };
    std::uint64_t retained = generation <= until ? step_forward(generation, rule_.keep_every) : generation;
    if (retained > until) {
        retained = step_forward(std::max(generation, until + 1), keep_every_);
    }
    return std::min(retained, last_generation());
}

bool Retention::is_hash_retained(std::uint64_t tick) const {
    return tick > rule_.until_tick || tick / ticks_per_hash % rule_.keep_every == 0;
}

std::uint64_t Retention::next_hash_after(std::uint64_t tick) const {
    const std::uint64_t next = tick / ticks_per_hash + 1, keep_every = rule_.keep_every;
    const std::uint64_t kept = (next + keep_every - 1) / keep_every * keep_every;
    const std::uint64_t until = rule_.until_tick / ticks_per_hash;
    return (kept <= until ? kept : std::max(next, until + 1)) * ticks_per_hash;
}

bool Retention::exceeds(std::int64_t bytes) {
    return !purge_ && (database_.number("PRAGMA page_count") - database_.number("PRAGMA freelist_count")) *
                              database_.number("PRAGMA page_size") >
                          bytes;
}

Result<bool> Retention::halve() {
    const std::uint64_t last = last_generation();
    // The storage thread may still write to the last two generations.
    if (purge_ || last < identity_.first_generation + 2 || last - 2 <= rule_.until_generation) {
        return false;
    }
    // Nothing is left to halve if only the first of the older generations is retained.
    const std::uint64_t twice = rule_.keep_every > last ? 1 : 2;
    RetentionRule next{
        .keep_every = twice * std::max(rule_.keep_every, keep_every_), .until_generation = last - 2, .until_tick = 0};
    next.until_tick = database_.natural("SELECT first_tick FROM generation WHERE generation = " +
                                        std::to_string(next.until_generation + 1));
    database_.begin();
    database_.run("DELETE FROM checkpoint WHERE generation <= " + std::to_string(next.until_generation) +
                  " AND (generation - " + std::to_string(identity_.first_generation) + ") % " +
                  std::to_string(next.keep_every) + " != 0");
    TableWriter<ThinnedTable>{database_.database}.write(
        ThinnedTable::Row{1 + database_.natural("SELECT max(number) FROM thinned"), next});
    if (auto committed = database_.commit(); !committed) {
        return committed.error();
    }
    rule_ = next;
    purge_ = Purge{};
    return true;
}

void Retention::resume_purge() {
    if (rule_.until_generation > 0) {
        purge_ = Purge{};
    }
}

Result<void> Retention::purge_generations() {
    constexpr std::uint64_t generations_at_once = 1000;
    constexpr std::int64_t pages_at_once = 64;
    const std::uint64_t until = std::min(rule_.until_generation, purge_->generation + generations_at_once);
    std::vector<std::int64_t> generations;
    for (Statement excluded{database_.database,
                            "SELECT DISTINCT generation FROM population WHERE generation > " +
                                std::to_string(purge_->generation) + " AND generation <= " + std::to_string(until) +
                                " AND (generation - " + std::to_string(identity_.first_generation) + ") % " +
                                std::to_string(rule_.keep_every) + " != 0 ORDER BY generation LIMIT 64"};
         excluded.row();) {
        generations.push_back(excluded.integer(0));
    }
    if (generations.empty()) {
        purge_->generation = until;
        return {};
    }
    database_.begin();
    const std::vector<const char*> tables = purged_tables(database_);
    const auto free_pages = [this] { return database_.number("PRAGMA freelist_count"); };
    const std::int64_t enough = free_pages() + pages_at_once;
    for (std::size_t i = 0; i < generations.size() && free_pages() < enough; ++i) {
        // Deletes the population last, because the query above finds a generation only while it has a population.
        for (const char* table : tables) {
            if (free_pages() < enough) {
                database_.run("DELETE FROM " + std::string{table} +
                              " WHERE generation = " + std::to_string(generations[i]));
            }
        }
    }
    return database_.commit();
}

Result<void> Retention::purge_step() {
    constexpr std::uint64_t hashes_at_once = 1000;
    if (purge_->generation < rule_.until_generation) {
        return purge_generations();
    }
    if (purge_->tick >= rule_.until_tick) {
        purge_.reset();
        return {};
    }
    const std::uint64_t until = std::min(rule_.until_tick, purge_->tick + hashes_at_once * ticks_per_hash);
    database_.begin();
    database_.run("DELETE FROM state_hash WHERE tick > " + std::to_string(purge_->tick) +
                  " AND tick <= " + std::to_string(until) + " AND tick / " + std::to_string(ticks_per_hash) + " % " +
                  std::to_string(rule_.keep_every) + " != 0");
    purge_->tick = until;
    return database_.commit();
}

} // namespace evod::run_file
