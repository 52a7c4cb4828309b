// Run database: the SQLite database of one run file, with its path for error messages.
//
// Owner        the RunFile. The objects for its tables refer to this database.
// Threads      one at a time.
#pragma once

#include "server/base/result.h"
#include "server/run_file/database.h"

#include <string>
#include <utility>

namespace evod::run_file {

struct RunDatabase {
    const std::string path;
    Database database;
    bool has_end_mark = false; // the file may contain an end mark; the first transaction deletes it

    RunDatabase(std::string file, Database::Mode mode, const char* vfs)
        : path{std::move(file)}, database{path, mode, vfs} {}

    bool failed() const { return database.failed(); }
    void run(const std::string& sql) { database.run(sql.c_str()); }
    /// The integer that a query returns; 0 if it returns no row.
    std::int64_t number(const std::string& sql) { return database.number(sql.c_str()); }
    std::uint64_t natural(const std::string& sql) { return static_cast<std::uint64_t>(number(sql)); }

    void begin() {
        run("BEGIN IMMEDIATE");
        if (has_end_mark) {
            run("DELETE FROM end_mark");
        }
    }
    /// After a failed commit, it is unknown whether the file contains the transaction.
    base::Result<void> commit() {
        run("COMMIT");
        has_end_mark = has_end_mark && failed();
        return unless_failed();
    }

    /// The error of the database, with the path of the file: DATA_LOSS if SQLite found damage, otherwise UNAVAILABLE.
    base::Refusal failure() const;
    /// A DATA_LOSS refusal whose message says that `what` is missing or was changed.
    base::Refusal damaged(const std::string& what) const;
    /// Returns the value, or failure() if the database has failed.
    template <class T>
    base::Result<T> unless_failed(T value) const {
        if (failed()) {
            return failure();
        }
        return value;
    }
    base::Result<void> unless_failed() const {
        if (failed()) {
            return failure();
        }
        return {};
    }
};

/// The name of a row in an error message: "the row 7 of its table journal".
std::string row_text(const std::string& table, std::uint64_t key);

} // namespace evod::run_file
