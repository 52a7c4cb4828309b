#include "server/run_file/check.h"

#include "server/run_file/rows.h"
#include "server/run_file/run_file.h"

#include <algorithm>

namespace evod::run_file {
namespace {

using base::RefusalCode;
using base::Result;

/// Checks a generation that is not retained. Only its opening and statistics are stored.
Result<void> check_purged_generation(RunFile& file, std::uint64_t generation) {
    const auto opening = file.generations().opening_of(generation);
    if (!opening) {
        return opening.error();
    }
    if (!*opening) {
        return file.damaged(row_text(GenerationTable::name, generation));
    }
    const auto statistics = file.generations().statistics_of(generation);
    if (!statistics) {
        return statistics.error();
    }
    if (statistics->size() != (*opening)->parameters.active.island_count) {
        return file.damaged("a row of the statistics of generation " + std::to_string(generation));
    }
    return {};
}

Result<void> check_generation(RunFile& file, std::uint64_t generation, std::uint64_t last) {
    const auto begun = file.generations().beginning_of(generation);
    if (!begun) {
        return begun.error();
    }
    const auto ended = file.generations().outcome_of(generation);
    if (!ended) {
        return ended.error();
    }
    if (!file.retention().is_retained(generation)) {
        return check_purged_generation(file, generation);
    }
    if (!*begun) {
        return file.damaged(row_text(GenerationTable::name, generation));
    }
    if (!*ended && generation < last) {
        return file.damaged("the outcome of generation " + std::to_string(generation));
    }
    return {};
}

Result<void> check_hashes(RunFile& file, const EndMark& contents) {
    constexpr std::uint64_t ticks_at_once = 100'000 * ticks_per_hash;
    const Retention& retention = file.retention();
    for (std::uint64_t next = retention.next_hash_after(file.identity().first_tick); next <= contents.tick;) {
        const auto hashes = file.hashes(next - 1, std::min(contents.tick, next + ticks_at_once));
        if (!hashes) {
            return hashes.error();
        }
        if (hashes->empty()) {
            if (file.database().number("SELECT max(tick) FROM state_hash") >= static_cast<std::int64_t>(next)) {
                return file.damaged(row_text(StateHashTable::name, next));
            }
            break; // the end mark shows whether the last hashes are missing
        }
        for (const HashRecord& hash : *hashes) {
            if (hash.tick != next) {
                return file.damaged(row_text(StateHashTable::name, next));
            }
            next = retention.next_hash_after(next);
        }
    }
    return {};
}

Result<void> check_checkpoints(RunFile& file, const EndMark& contents) {
    bool begins_with_one = false;
    const RunIdentity& identity = file.identity();
    const std::int64_t newest = file.database().number("SELECT max(tick) FROM checkpoint");
    for (std::int64_t after = -1; after < newest && !file.database().failed();) {
        // Reads one checkpoint at a time, because checkpoints may be large.
        const auto next = file.checkpoints().next(after);
        if (!next) {
            return next.error();
        }
        if (!*next) {
            break;
        }
        const StoredCheckpoint& checkpoint = **next;
        after = static_cast<std::int64_t>(checkpoint.moment.tick);
        const auto opening = file.generations().opening_of(checkpoint.moment.generation);
        if (!opening) {
            return opening.error();
        }
        if (!*opening || !file.retention().is_retained(checkpoint.moment.generation) ||
            checkpoint.moment.tick < identity.first_tick ||
            (*opening)->moment.tick + checkpoint.moment.generation_tick != checkpoint.moment.tick ||
            (checkpoint.moment.generation_tick == 0 &&
             !(identity.forked_from && checkpoint.moment.tick == identity.first_tick)) ||
            checkpoint.journal_entries > contents.journal_entries) {
            return file.damaged(row_text(CheckpointRowTable::name, checkpoint.moment.tick));
        }
        begins_with_one |= checkpoint.moment.tick == identity.first_tick;
    }
    const auto first = file.generations().opening_of(identity.first_generation);
    if (!first) {
        return first.error();
    }
    if (*first && (*first)->moment.tick < identity.first_tick && !begins_with_one) {
        return file.damaged(row_text(CheckpointRowTable::name, identity.first_tick));
    }
    return {};
}

} // namespace

Result<void> check_tree(RunDatabase& database, const std::string& table) {
    Statement integrity{database.database, "PRAGMA integrity_check(" + table + ")"};
    if (integrity.row()) {
        if (const std::string verdict = integrity.text(0); verdict != "ok") {
            return refusal(RefusalCode::DataLoss, database.path + " is damaged: " + verdict);
        }
    }
    return {};
}

Result<void> check_end_mark(RunFile& file) {
    const auto mark = file.end_mark();
    if (!mark) {
        return mark.error();
    }
    const EndMark found = file.contents();
    if (*mark && ((*mark)->tick != found.tick || (*mark)->generations != found.generations ||
                  (*mark)->hashes != found.hashes || (*mark)->journal_entries != found.journal_entries)) {
        return file.damaged("a row before its end mark");
    }
    return file.database().unless_failed();
}

Result<void> check(RunFile& file) {
    return check(file, [](std::uint64_t) {});
}

Result<void> check(RunFile& file, base::FunctionRef<void(std::uint64_t generation)> progress) {
    if (auto sound = check_tree(file.database(), "1"); !sound) {
        return sound;
    }
    if (auto entries = file.journal().read(); !entries) {
        return entries.error();
    }
    const RunIdentity& identity = file.identity();
    if (auto inherited = file.generations().history(identity.first_generation, identity.inherited_generations);
        !inherited) {
        return inherited.error();
    }
    const std::uint64_t last = file.generations().last();
    for (std::uint64_t generation = identity.first_generation; generation <= last; ++generation) {
        progress(generation);
        if (auto checked = check_generation(file, generation, last); !checked) {
            return checked;
        }
    }
    const EndMark contents = file.contents();
    if (auto checked = check_hashes(file, contents); !checked) {
        return checked;
    }
    if (auto checked = check_checkpoints(file, contents); !checked) {
        return checked;
    }
    return check_end_mark(file);
}

} // namespace evod::run_file
