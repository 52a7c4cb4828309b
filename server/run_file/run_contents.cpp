#include "server/run_file/run_contents.h"

#include "server/run_file/rows.h"

#include <algorithm>
#include <utility>

namespace evod::run_file {

using base::Refusal;
using base::RefusalCode;
using base::Result;

std::optional<Refusal> RunContents::other_model() const {
    if (identity().model_version == simulation::model_version) {
        return std::nullopt;
    }
    return refusal(RefusalCode::FailedPrecondition,
                   path() + " was created by evod " + identity().evod_version + " with model version " +
                       std::to_string(identity().model_version) + "; this evod " + EVOD_VERSION +
                       " has model version " + std::to_string(simulation::model_version) +
                       ", so it can read the file (`evod export`) but not simulate the run again");
}

Result<std::vector<HashRecord>> RunContents::hashes(std::uint64_t after, std::uint64_t until) {
    std::vector<HashRecord> hashes;
    TableReader<StateHashTable> reader{database_.database,
                                       "tick > ? AND tick <= ? ORDER BY tick",
                                       {static_cast<std::int64_t>(after), static_cast<std::int64_t>(until)}};
    HashRecord hash;
    while (reader.next(hash)) {
        if (!reader.sound()) {
            return database_.damaged(row_text(StateHashTable::name, hash.tick));
        }
        if (retention_.is_hash_retained(hash.tick)) { // skips hashes that the next purge deletes
            hashes.push_back(hash);
        }
    }
    return database_.unless_failed(std::move(hashes));
}

Result<std::optional<EndMark>> RunContents::end_mark() {
    TableReader<EndMarkTable> reader{database_.database, "1"};
    EndMarkTable::Row row;
    if (!reader.next(row)) {
        return database_.unless_failed(std::optional<EndMark>{});
    }
    if (!reader.sound()) {
        return database_.damaged("its end mark");
    }
    row.mark.ended = row.how == "ended";
    return std::optional{row.mark};
}

std::uint64_t RunContents::last_tick() {
    std::uint64_t last = 0;
    // The recorder writes a generation after its first tick. It writes the first generation of a run before its first
    // tick.
    const std::string bred =
        "SELECT max(first_tick + 1) FROM generation WHERE generation > " + std::to_string(identity().first_generation);
    for (const char* sql :
         {"SELECT tick FROM journal ORDER BY number DESC LIMIT 1", "SELECT max(tick) FROM state_hash",
          "SELECT max(first_tick) FROM generation", bred.c_str(), "SELECT max(end_tick) FROM statistics",
          "SELECT max(tick) FROM end_mark", "SELECT max(tick) FROM checkpoint"}) {
        last = std::max(last, database_.natural(sql));
    }
    return last;
}

EndMark RunContents::contents() {
    return {.ended = false,
            .tick = last_tick(),
            .journal_entries = database_.natural("SELECT count(*) FROM journal"),
            .generations = generations_.last(),
            .hashes = database_.natural("SELECT count(*) FROM state_hash")};
}

} // namespace evod::run_file
