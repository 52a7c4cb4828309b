#include "server/classes/registry.h"

#include "evod/v1/commands.pb.h"
#include "server/classes/codes.h"
#include "server/classes/names.h"
#include "server/classes/ranges.h"
#include "server/run_file/data_folder.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <set>
#include <span>
#include <utility>

namespace evod::classes {
namespace {

using base::RefusalCode;
using base::Result;
using run_file::Database;
using run_file::Statement;

constexpr std::int64_t application_id = 0x45564343; // "EVCC"
constexpr std::int64_t format_version = 1;
// SQLite copies the log into the file when it has so many pages.
constexpr std::uint32_t log_pages_max = 1000;

constexpr const char* tables = R"sql(
CREATE TABLE class(name TEXT PRIMARY KEY, teacher TEXT NOT NULL, code TEXT, code_ends_s INTEGER,
  frozen INTEGER NOT NULL, world_template BLOB NOT NULL, own_seeds INTEGER NOT NULL, member_worlds_max INTEGER NOT NULL,
  lesson TEXT NOT NULL, last_number INTEGER NOT NULL) STRICT, WITHOUT ROWID;
CREATE TABLE range(class TEXT NOT NULL, parameter TEXT NOT NULL, min REAL NOT NULL, max REAL NOT NULL,
  PRIMARY KEY(class, parameter)) STRICT, WITHOUT ROWID;
CREATE TABLE member(class TEXT NOT NULL, number INTEGER NOT NULL, name TEXT NOT NULL, slug TEXT NOT NULL,
  removed INTEGER NOT NULL, joined INTEGER NOT NULL, tokens BLOB NOT NULL, personal_code BLOB,
  PRIMARY KEY(class, number)) STRICT, WITHOUT ROWID;
)sql";

void write_class(Database& database, const Class& of) {
    Statement row{database, "INSERT OR REPLACE INTO class VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?)"};
    row.bind(0, std::string_view{of.name});
    row.bind(1, std::string_view{of.teacher});
    if (of.code) {
        row.bind(2, std::string_view{of.code->letters});
        row.bind(3, of.code->ends_at_s);
    }
    row.bind(4, std::int64_t{of.frozen});
    row.bind(5, std::as_bytes(std::span{of.world_template}));
    row.bind(6, std::int64_t{of.own_seeds});
    row.bind(7, std::int64_t{of.member_worlds_max});
    row.bind(8, std::string_view{of.lesson});
    row.bind(9, std::int64_t{of.last_number});
    row.done();
}

void write_ranges(Database& database, const Class& of) {
    Statement old{database, "DELETE FROM range WHERE class = ?"};
    old.bind(0, std::string_view{of.name});
    old.done();
    Statement row{database, "INSERT INTO range VALUES (?, ?, ?, ?)"};
    for (const Range& range : of.ranges) {
        row.bind(0, std::string_view{of.name});
        row.bind(1, std::string_view{range.parameter});
        row.bind(2, range.min);
        row.bind(3, range.max);
        row.done();
    }
}

void write_member(Database& database, const Class& of, const Member& member) {
    Statement row{database, "INSERT OR REPLACE INTO member VALUES (?, ?, ?, ?, ?, ?, ?, ?)"};
    row.bind(0, std::string_view{of.name});
    row.bind(1, std::int64_t{member.number});
    row.bind(2, std::string_view{member.name});
    row.bind(3, std::string_view{member.slug});
    row.bind(4, std::int64_t{member.removed});
    row.bind(5, std::int64_t{member.joined});
    row.bind(6, std::as_bytes(std::span{member.tokens}));
    if (member.personal_code) {
        row.bind(7, std::as_bytes(std::span{*member.personal_code}));
    }
    row.done();
}

void erase_member(Database& database, const std::string& of, std::uint32_t number) {
    Statement row{database, "DELETE FROM member WHERE class = ? AND number = ?"};
    row.bind(0, std::string_view{of});
    row.bind(1, std::int64_t{number});
    row.done();
}

void erase_class(Database& database, const std::string& name) {
    for (const char* sql : {"DELETE FROM class WHERE name = ?", "DELETE FROM range WHERE class = ?",
                            "DELETE FROM member WHERE class = ?"}) {
        Statement row{database, sql};
        row.bind(0, std::string_view{name});
        row.done();
    }
}

std::optional<Digest> digest_from(const std::string& bytes) {
    Digest digest;
    if (bytes.size() != digest.size()) {
        return std::nullopt;
    }
    std::memcpy(digest.data(), bytes.data(), digest.size());
    return digest;
}

Classes read_all(Database& database) {
    Classes classes;
    Statement of_class{database, "SELECT name, teacher, code, code_ends_s, frozen, world_template, own_seeds, "
                                 "member_worlds_max, lesson, last_number FROM class"};
    while (of_class.row()) {
        Class read{.name = of_class.text(0), .teacher = of_class.text(1), .world_template = of_class.bytes(5)};
        if (!of_class.is_null(2)) {
            read.code = {of_class.text(2), of_class.integer(3)};
        }
        read.frozen = of_class.integer(4) != 0;
        read.own_seeds = of_class.integer(6) != 0;
        read.member_worlds_max = static_cast<std::uint32_t>(of_class.integer(7));
        read.lesson = of_class.text(8);
        read.last_number = static_cast<std::uint32_t>(of_class.integer(9));
        classes.emplace(read.name, read);
    }
    Statement of_range{database, "SELECT class, parameter, min, max FROM range"};
    while (of_range.row()) {
        classes[of_range.text(0)].ranges.push_back({of_range.text(1), of_range.real(2), of_range.real(3)});
    }
    Statement of_member{database, "SELECT class, number, name, slug, removed, joined, tokens, personal_code FROM "
                                  "member ORDER BY number"};
    while (of_member.row()) {
        Member read{.number = static_cast<std::uint32_t>(of_member.integer(1)),
                    .name = of_member.text(2),
                    .slug = of_member.text(3),
                    .removed = of_member.integer(4) != 0,
                    .joined = of_member.integer(5) != 0};
        const std::string tokens = of_member.bytes(6);
        for (std::size_t at = 0; at < tokens.size(); at += sizeof(Digest)) {
            read.tokens.push_back(digest_from(tokens.substr(at, sizeof(Digest))).value_or(Digest{}));
        }
        if (!of_member.is_null(7)) {
            read.personal_code = digest_from(of_member.bytes(7)).value_or(Digest{});
        }
        classes[of_member.text(0)].members.push_back(std::move(read));
    }
    return classes;
}

/// Returns what is wrong with a class from the file; empty: nothing is.
std::string fault_of(const std::string& key, Class& read) {
    if (key != read.name || !is_class_name(read.name)) {
        return "the class \"" + key + "\" of its table class";
    }
    std::vector<base::Violation> violations;
    const std::vector<Range> stored = std::exchange(read.ranges, {});
    read.ranges = ranges_of(to_proto(stored), "range", violations);
    v1::CreateWorld world;
    const bool has_template = world.ParseFromString(read.world_template) && world.has_seed() && world.name().empty();
    const bool has_code = !read.code || normalised_code(read.code->letters) == read.code->letters;
    if (!violations.empty() || !has_template || !has_code || read.lesson.size() > lesson_name_bytes_max ||
        read.member_worlds_max < member_worlds_least || read.member_worlds_max > member_worlds_most ||
        read.members.size() > members_max) {
        return "the class \"" + key + "\"";
    }
    std::set<std::string> slugs, names;
    std::uint32_t last = 0;
    for (const Member& member : read.members) {
        const auto name = cleaned_member_name(member.name, "name");
        const bool is_new = names.insert(folded(member.name)).second && slugs.insert(member.slug).second;
        if (!name || *name != member.name || member.name.empty() || !is_new || slug_of(member.slug) != member.slug ||
            member.number <= last || member.number > read.last_number || member.tokens.size() > member_tokens_max) {
            return "the member " + std::to_string(member.number) + " of the class \"" + key + "\"";
        }
        last = member.number;
    }
    return {};
}

/// Whether the name of a member is no longer part of the class.
bool loses_a_name(const Class* before, const Class* after) {
    return before != nullptr && std::ranges::any_of(before->members, [&](const Member& member) {
               return after == nullptr ||
                      std::ranges::find(after->members, member.name, &Member::name) == after->members.end();
           });
}

} // namespace

std::string Registry::path() const {
    return run_file::classes_file_of(file_->folder);
}

Result<Registry> Registry::open(const std::optional<File>& file) {
    Registry registry{file};
    if (file) {
        if (auto read = registry.read(); !read) {
            return read.error();
        }
    }
    return registry;
}

Result<void> Registry::read() {
    std::error_code error;
    if (!std::filesystem::exists(std::filesystem::symlink_status(path(), error)) ||
        std::filesystem::file_size(path(), error) == 0) { // a server was killed before its first transaction
        return {};
    }
    if (auto sound = run_file::expect_file_with_one_name(path()); !sound) {
        return sound;
    }
    const auto damaged = [&](const std::string& what) {
        return refusal(RefusalCode::DataLoss,
                       path() + " is damaged: " + what +
                           ": restore it from a backup, or move it away to start without classes");
    };
    // Opened for writing, because SQLite must bring in the log that a killed server left.
    Database database{path(), Database::Mode::Write};
    const bool is_ours = database.number("PRAGMA application_id") == application_id;
    if (!database.failed() && (!is_ours || database.number("PRAGMA user_version") != format_version)) {
        return damaged("it is not the file of classes of this version of evod");
    }
    Statement check{database, "PRAGMA quick_check(1)"};
    if (check.row() && check.text(0) != "ok") {
        return damaged(check.text(0));
    }
    Classes read = read_all(database);
    if (database.failed()) {
        return database.damaged() ? damaged(database.error())
                                  : refusal(RefusalCode::Unavailable, path() + ": " + database.error());
    }
    for (auto& [name, of] : read) {
        if (const std::string fault = fault_of(name, of); !fault.empty()) {
            return damaged(fault);
        }
    }
    classes_ = std::move(read);
    return {};
}

Result<void> Registry::open_for_writing() {
    const std::string file = path();
    // Names of students are nothing for other users. SQLite gives its log the permissions of the file.
    const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (descriptor < 0) {
        return refusal(RefusalCode::Unavailable, "cannot write " + file + ": " + std::strerror(errno));
    }
    ::close(descriptor);
    database_ = std::make_unique<Database>(file, Database::Mode::Write);
    Database& database = *database_;
    database.run("PRAGMA journal_mode = WAL");
    database.run("PRAGMA secure_delete = ON"); // a deleted name must not stay in the file
    database.run(file_->durability == run_file::Durability::Full ? "PRAGMA synchronous = FULL"
                                                                 : "PRAGMA synchronous = NORMAL");
    if (database.number("SELECT count(*) FROM sqlite_schema") == 0) {
        database.run("BEGIN IMMEDIATE");
        database.run(("PRAGMA application_id = " + std::to_string(application_id)).c_str());
        database.run(("PRAGMA user_version = " + std::to_string(format_version)).c_str());
        database.run(tables);
        database.run("COMMIT");
    }
    return {};
}

void Registry::write_differences(const Class* before, const Class* after) {
    Database& database = *database_;
    if (after == nullptr) {
        return erase_class(database, before->name);
    }
    write_class(database, *after);
    if (before == nullptr || before->ranges != after->ranges) {
        write_ranges(database, *after);
    }
    for (const Member& member : after->members) {
        if (before == nullptr || std::ranges::find(before->members, member) == before->members.end()) {
            write_member(database, *after, member);
        }
    }
    if (before != nullptr) {
        for (const Member& member : before->members) {
            if (std::ranges::find(after->members, member.number, &Member::number) == after->members.end()) {
                erase_member(database, before->name, member.number);
            }
        }
    }
}

Result<void> Registry::write(const Class* before, const Class* after) {
    if (!file_) {
        return {};
    }
    if (!database_) {
        if (auto opened = open_for_writing(); !opened) {
            return opened;
        }
    }
    database_->run("BEGIN IMMEDIATE");
    if (is_unknown_) {
        database_->run("DELETE FROM class; DELETE FROM range; DELETE FROM member");
        for (const auto& [name, of] : classes_) {
            if (before == nullptr || name != before->name) {
                write_differences(nullptr, &of);
            }
        }
        before = after != nullptr ? nullptr : before;
    }
    write_differences(before, after);
    database_->run("COMMIT");
    if (database_->failed()) {
        const std::string why = database_->error();
        database_.reset();
        is_unknown_ = true;
        return refusal(RefusalCode::Unavailable, "the change of the class cannot be written: " + path() + ": " + why);
    }
    is_unknown_ = false;
    if (loses_a_name(before, after)) {
        database_->run("PRAGMA wal_checkpoint(TRUNCATE)"); // nor in its log
    } else if (database_->log_pages() > log_pages_max) {
        database_->copy_log();
    }
    return {};
}

Result<void> Registry::store(Class changed) {
    const auto there = classes_.find(changed.name);
    if (there == classes_.end() && classes_.size() >= classes_max) {
        return base::limit_refusal("the server has " + std::to_string(classes_max) + " classes: delete one first",
                                   base::Reason::ClassesMax, "classes_max", classes_.size(), classes_max);
    }
    if (auto written = write(there == classes_.end() ? nullptr : &there->second, &changed); !written) {
        return written;
    }
    std::string name = changed.name;
    classes_.insert_or_assign(std::move(name), std::move(changed));
    return {};
}

Result<void> Registry::erase(const std::string& name) {
    const auto there = classes_.find(name);
    if (there == classes_.end()) {
        return {};
    }
    if (auto written = write(&there->second, nullptr); !written) {
        return written;
    }
    classes_.erase(there);
    return {};
}

} // namespace evod::classes
