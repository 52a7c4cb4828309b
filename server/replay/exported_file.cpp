#include "server/replay/exported_file.h"

#include "evod/v1/commands.pb.h"
#include "server/replay/generation_reader.h"
#include "server/run_file/data_folder.h"
#include "server/run_file/rows.h"
#include "server/run_file/run_database.h"

#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <utility>
#include <vector>

namespace evod::replay {
namespace {

using base::RefusalCode;
using base::Result;
using run_file::Database;
using run_file::RunDatabase;

base::Refusal cannot(const char* act, const std::string& path) {
    return refusal(RefusalCode::Unavailable,
                   std::string{"cannot "} + act + " a copy of the run file, " + path + ": " + std::strerror(errno));
}

/// A new, empty file, which is deleted with this object.
class TemporaryFile {
  public:
    static Result<TemporaryFile> next_to(const std::string& run_file) {
        std::string path = run_file + std::string{run_file::DataFolder::copy_mark} + "XXXXXX";
        const int descriptor = ::mkstemp(path.data());
        if (descriptor < 0) {
            return cannot("create", path);
        }
        return TemporaryFile{std::move(path), descriptor};
    }
    TemporaryFile(TemporaryFile&& other) noexcept
        : path_{std::exchange(other.path_, {})}, descriptor_{std::exchange(other.descriptor_, -1)} {}
    TemporaryFile& operator=(TemporaryFile&&) = delete;
    ~TemporaryFile() {
        remove_name();
        if (descriptor_ >= 0) {
            ::close(descriptor_);
        }
    }
    const std::string& path() const { return path_; }
    int descriptor() const { return descriptor_; }
    /// The contents stay until the object is destroyed.
    void remove_name() {
        if (!path_.empty()) {
            (void)run_file::remove_run_file(std::exchange(path_, {}));
        }
    }

  private:
    TemporaryFile(std::string path, int descriptor) : path_{std::move(path)}, descriptor_{descriptor} {}
    std::string path_;
    int descriptor_;
};

/// In the place of every client key, because a command must have one.
constexpr const char* key_in_copies = "exported";

/// Removes from a journal what must not leave the server.
Result<void> clean_journal(RunDatabase& copy, bool only_users, const base::StopCheck& stop) {
    run_file::TableWriter<run_file::JournalTable> writer{copy.database};
    const std::uint64_t last = copy.natural("SELECT max(number) FROM journal");
    for (std::uint64_t number = 1; number <= last; ++number) {
        if (stop()) {
            return cancelled_refusal();
        }
        run_file::TableReader<run_file::JournalTable> reader{
            copy.database, "number = ?", {static_cast<std::int64_t>(number)}};
        run_file::JournalEntry entry;
        v1::Request request;
        if (!reader.next(entry) || !reader.sound() || !request.ParseFromString(entry.origin.request)) {
            return copy.damaged(run_file::row_text(run_file::JournalTable::name, number));
        }
        request.set_client_key(key_in_copies);
        request.set_request_id(number);
        entry.origin.request = request.SerializeAsString();
        entry.origin.client_key = key_in_copies;
        entry.origin.request_id = number;
        entry.answer.clear();
        if (only_users) {
            entry.origin.by.program.clear();
            entry.origin.by.address.clear();
        }
        writer.write(entry);
    }
    return {};
}

/// Copies the run file to `first`, and from there without unwanted bytes to `second`.
Result<void> copy(run_file::RunFile& file, const std::string& first, const std::string& second, bool only_users,
                  const base::StopCheck& stop) {
    if (auto copied = file.copy_to(first, stop); !copied) {
        return copied;
    }
    if (stop()) {
        return cancelled_refusal();
    }
    RunDatabase database{first, Database::Mode::Write, nullptr};
    database.database.stop_when(stop);
    database.run("PRAGMA journal_mode = OFF"); // after an error the copy is deleted
    database.run("PRAGMA synchronous = OFF");
    database.run("BEGIN");
    if (auto cleaned = clean_journal(database, only_users, stop); !cleaned) {
        return cleaned;
    }
    database.run("COMMIT");
    run_file::Statement vacuum{database.database, "VACUUM INTO ?"};
    vacuum.bind(0, second);
    vacuum.done();
    return database.unless_failed();
}

} // namespace

Result<void> write_exported_file(run_file::RunFile& file, bool only_users, const base::StopCheck& stop,
                                 std::ostream& out) {
    auto second = TemporaryFile::next_to(file.path());
    if (!second) {
        return second.error();
    }
    {
        auto first = TemporaryFile::next_to(file.path());
        if (!first) {
            return first.error();
        }
        if (auto copied = copy(file, first->path(), second->path(), only_users, stop); !copied) {
            return stop() ? cancelled_refusal() : copied.error();
        }
    }
    const std::string path = second->path();
    second->remove_name();
    std::vector<char> block(64 << 10);
    ::off_t at = 0;
    while (out) {
        const ::ssize_t count = ::pread(second->descriptor(), block.data(), block.size(), at);
        if (count < 0) {
            return cannot("read", path);
        }
        if (count == 0) {
            break;
        }
        out.write(block.data(), count);
        at += count;
    }
    return {};
}

} // namespace evod::replay
