#include "server/run_file/checkpoints.h"

#include "server/run_file/checkpoint.h"
#include "server/run_file/rows.h"

#include <utility>

namespace evod::run_file {

using base::Result;

Result<std::vector<StoredCheckpoint>> Checkpoints::read(std::int64_t after, std::uint64_t until) {
    return read_where("tick > ? AND tick <= ? ORDER BY tick", {after, static_cast<std::int64_t>(until)});
}

Result<std::optional<StoredCheckpoint>> Checkpoints::last(std::uint64_t until) {
    auto found = read_where("tick <= ? ORDER BY tick DESC LIMIT 1", {static_cast<std::int64_t>(until)});
    if (!found) {
        return found.error();
    }
    return found->empty() ? std::nullopt : std::optional{std::move(found->front())};
}

Result<std::optional<StoredCheckpoint>> Checkpoints::next(std::int64_t after) {
    auto found = read_where("tick > ? ORDER BY tick LIMIT 1", {after});
    if (!found) {
        return found.error();
    }
    return found->empty() ? std::nullopt : std::optional{std::move(found->front())};
}

Result<void> Checkpoints::read_parts(std::uint64_t tick, std::string& state, std::vector<std::int64_t>& checksums) {
    TableReader<CheckpointPartTable> parts{
        database_.database, "tick = ? ORDER BY part", {static_cast<std::int64_t>(tick)}};
    CheckpointPartTable::Row row{};
    while (parts.next(row)) {
        const std::uint64_t expected = checksums.size() + 1;
        if (!parts.sound() || row.part != expected) {
            return database_.damaged("part " + std::to_string(expected) + " of " +
                                     row_text(CheckpointRowTable::name, tick));
        }
        state += row.bytes;
        checksums.push_back(parts.checksum());
    }
    return database_.unless_failed();
}

Result<std::vector<StoredCheckpoint>> Checkpoints::read_where(const std::string& condition,
                                                              const std::vector<std::int64_t>& values) {
    std::vector<StoredCheckpoint> found;
    TableReader<CheckpointRowTable> reader{database_.database, condition, values};
    CheckpointRowTable::Row row;
    StoredCheckpoint checkpoint;
    Result<void> parts;
    // While this row is being read, a server cannot delete the parts of its checkpoint.
    row.parts.read = [&] {
        checkpoint.state.clear();
        parts = read_parts(row.moment.tick, checkpoint.state, row.parts.values);
    };
    while (reader.next(row)) {
        if (!parts) {
            return parts.error();
        }
        if (!reader.sound()) {
            return database_.damaged(row_text(CheckpointRowTable::name, row.moment.tick));
        }
        const auto set = parameter_sets_.read(row.parameters);
        if (!set) {
            return set.error();
        }
        checkpoint.moment = row.moment;
        checkpoint.parameters = *set;
        checkpoint.hash = row.hash;
        checkpoint.journal_entries = row.journal_entries;
        checkpoint.state += row.state;
        found.push_back(std::exchange(checkpoint, {}));
    }
    return database_.unless_failed(std::move(found));
}

void Checkpoints::write(const Checkpoint& checkpoint) {
    if (!database_.failed() && retention_.is_retained(checkpoint.state.moment.generation)) {
        write(pack(checkpoint));
    }
}

void Checkpoints::write(const StoredCheckpoint& checkpoint) {
    if (database_.failed() || !retention_.is_retained(checkpoint.moment.generation)) {
        return;
    }
    Unfinished unfinished{.tick = checkpoint.moment.tick};
    while (!write_next(checkpoint, unfinished)) {
    }
}

bool Checkpoints::is_written(const StoredCheckpoint& checkpoint) {
    const std::uint64_t tick = checkpoint.moment.tick;
    const bool begun = unfinished_ && unfinished_->tick == tick;
    // A run has only one state after a given tick. So a row with this tick contains this checkpoint: an earlier commit
    // succeeded although it was reported as failed.
    const bool written =
        !retention_.is_retained(checkpoint.moment.generation) ||
        (!begun && database_.number("SELECT count(*) FROM checkpoint WHERE tick = " + std::to_string(tick)) != 0);
    if (written) {
        unfinished_.reset();
        expect_orphans();
    }
    return written;
}

bool Checkpoints::write_part(const StoredCheckpoint& checkpoint) {
    if (!unfinished_ || unfinished_->tick != checkpoint.moment.tick) {
        unfinished_ = Unfinished{.tick = checkpoint.moment.tick};
    }
    return write_next(checkpoint, *unfinished_);
}

void Checkpoints::part_written(bool was_last) {
    if (was_last) {
        unfinished_.reset();
    }
}

bool Checkpoints::write_next(const StoredCheckpoint& checkpoint, Unfinished& unfinished) {
    // Parts from a server that was killed, or of a checkpoint that is being replaced.
    if (unfinished.checksums.empty()) {
        database_.run("DELETE FROM checkpoint_part WHERE tick = " + std::to_string(unfinished.tick));
    }
    const auto rest = std::as_bytes(std::span{checkpoint.state}).subspan(unfinished.checksums.size() * part_bytes_);
    if (rest.size() > part_bytes_) {
        unfinished.checksums.push_back(TableWriter<CheckpointPartTable>{database_.database}.write(
            CheckpointPartTable::View{unfinished.tick, unfinished.checksums.size() + 1, rest.first(part_bytes_)}));
        return false;
    }
    const std::int64_t parameters = parameter_sets_.number_of(checkpoint.parameters);
    TableWriter<CheckpointRowTable>{database_.database}.write(
        CheckpointRowTable::View{checkpoint.moment, parameters, checkpoint.journal_entries, checkpoint.hash,
                                 CoveredChecksums{unfinished.checksums}, rest});
    database_.run("DELETE FROM checkpoint WHERE tick != " + std::to_string(identity_.first_tick) +
                  " AND tick NOT IN (SELECT tick FROM checkpoint ORDER BY tick DESC LIMIT " +
                  std::to_string(retained_count) + ")");
    expect_orphans();
    return true;
}

std::string Checkpoints::orphans_condition() const {
    const std::string orphans = "tick NOT IN (SELECT tick FROM checkpoint)";
    return unfinished_ ? orphans + " AND tick != " + std::to_string(unfinished_->tick) : orphans;
}

bool Checkpoints::has_orphans() {
    may_have_orphans_ = database_.number("SELECT count(*) FROM checkpoint_part WHERE " + orphans_condition()) != 0;
    return may_have_orphans_;
}

void Checkpoints::delete_some_orphans() {
    constexpr int parts_at_once = 2;
    database_.run("DELETE FROM checkpoint_part WHERE rowid IN (SELECT rowid FROM checkpoint_part WHERE " +
                  orphans_condition() + " LIMIT " + std::to_string(parts_at_once) + ")");
}

void Checkpoints::delete_all_orphans() {
    unfinished_.reset();
    database_.run("DELETE FROM checkpoint_part WHERE " + orphans_condition());
}

} // namespace evod::run_file
