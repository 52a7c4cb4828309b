#include "server/run_file/journal.h"

#include "server/run_file/check.h"

#include <algorithm>
#include <utility>

namespace evod::run_file {

base::Result<std::vector<JournalEntry>> Journal::read(std::uint64_t first, std::uint32_t count, std::size_t bytes_max) {
    if (first == 1) {
        if (auto sound = check_tree(database_, JournalTable::name); !sound) {
            return sound.error();
        }
    }
    std::vector<JournalEntry> entries;
    TableReader<JournalTable> reader{
        database_.database, "number >= ? ORDER BY number LIMIT ?", {static_cast<std::int64_t>(first), count}};
    JournalEntry entry;
    std::size_t bytes = 0;
    while (bytes <= bytes_max && reader.next(entry)) {
        const std::uint64_t expected = first + entries.size();
        if (!reader.sound() || entry.number != expected) {
            return database_.damaged(row_text(JournalTable::name, expected));
        }
        bytes += entry.origin.request.size() + entry.answer.size();
        entries.push_back(std::move(entry));
    }
    return database_.unless_failed(std::move(entries));
}

base::Result<std::vector<UsedKey>> Journal::used_keys(std::uint64_t last, std::size_t keys_max) {
    // Ids from 2^63 on are stored as negative numbers.
    Statement keys{database_.database, "SELECT user, client_key, max(number), max(request_id), "
                                       "max(CASE WHEN request_id < 0 THEN request_id END) FROM journal "
                                       "WHERE number <= ? GROUP BY user, client_key ORDER BY 3 DESC LIMIT ?"};
    keys.bind(0, static_cast<std::int64_t>(last));
    keys.bind(1, static_cast<std::int64_t>(keys_max));
    Statement sender{database_.database, "SELECT sender, address FROM journal WHERE number = ?"};
    std::vector<UsedKey> used;
    while (keys.row()) {
        UsedKey& key = used.emplace_back();
        key.by = base::client_actor(keys.text(0), {}, {});
        key.client_key = keys.text(1);
        key.highest_id = static_cast<std::uint64_t>(keys.is_null(4) ? keys.integer(3) : keys.integer(4));
        if (key.by.user.empty()) { // a client without a token, or the server
            sender.bind(0, keys.integer(2));
            while (sender.row()) {
                key.by.kind = static_cast<base::Actor::Kind>(sender.integer(0));
                key.by.address = sender.text(1);
            }
        }
    }
    std::ranges::reverse(used);
    return database_.unless_failed(std::move(used));
}

void Journal::write(const JournalEntry& entry) {
    if (!writer_) {
        writer_.emplace(database_.database);
    }
    writer_->write(entry);
}

} // namespace evod::run_file
