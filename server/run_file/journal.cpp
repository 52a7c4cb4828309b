#include "server/run_file/journal.h"

#include "server/run_file/check.h"

#include <utility>

namespace evod::run_file {

base::Result<std::vector<JournalEntry>> Journal::read(std::uint64_t first, std::uint32_t count) {
    if (first == 1) {
        if (auto sound = check_tree(database_, JournalTable::name); !sound) {
            return sound.error();
        }
    }
    std::vector<JournalEntry> entries;
    TableReader<JournalTable> reader{
        database_.database, "number >= ? ORDER BY number LIMIT ?", {static_cast<std::int64_t>(first), count}};
    JournalEntry entry;
    while (reader.next(entry)) {
        const std::uint64_t expected = first + entries.size();
        if (!reader.sound() || entry.number != expected) {
            return database_.damaged(row_text(JournalTable::name, expected));
        }
        entries.push_back(std::move(entry));
    }
    return database_.unless_failed(std::move(entries));
}

void Journal::write(const JournalEntry& entry) {
    if (!writer_) {
        writer_.emplace(database_.database);
    }
    writer_->write(entry);
}

} // namespace evod::run_file
