// Registry: the classes of a server, in memory and in the file `classes.sqlite` of the data folder.
//
// Owner        the server, on the network thread.
// Durable      store() and erase() write one transaction and return when it is as durable as the server promises for
//              commands. If that fails, nothing has changed in memory, and the next change writes the whole file again,
//              because the file may or may not contain the failed one.
// Full         at most classes_max classes of members_max members.
#pragma once

#include "server/base/result.h"
#include "server/classes/class.h"
#include "server/run_file/database.h"
#include "server/run_file/run_file.h"

#include <memory>
#include <optional>
#include <string>

namespace evod::classes {

class Registry {
  public:
    struct File {
        std::string folder; // the data folder, which this process has locked
        run_file::Durability durability = run_file::Durability::Full;
    };
    /// Reads the classes. Creates no file before there is a class. Refused if the file cannot be read or is damaged.
    ///
    /// file  nullopt: the classes are in memory only.
    /// Classes in memory only.
    Registry() = default;
    static base::Result<Registry> open(const std::optional<File>& file);

    const Classes& classes() const { return classes_; }
    /// Stores a new class, or the new state of a class. Refused if it cannot be written, and if there are classes_max
    /// other classes.
    base::Result<void> store(Class changed);
    /// Deletes a class.
    base::Result<void> erase(const std::string& name);

  private:
    explicit Registry(std::optional<File> file) : file_{std::move(file)} {}
    base::Result<void> read();
    /// Opens the file for writing, and creates it if it does not exist.
    base::Result<void> open_for_writing();
    /// Writes the difference between the stored state of a class and its next state as one transaction.
    ///
    /// before, after  nullptr: there is no such class.
    base::Result<void> write(const Class* before, const Class* after);
    void write_differences(const Class* before, const Class* after);
    std::string path() const;

    std::optional<File> file_;
    std::unique_ptr<run_file::Database> database_; // nullptr: not open for writing
    bool is_unknown_ = false;                      // the file may differ from `classes_`
    Classes classes_;
};

} // namespace evod::classes
