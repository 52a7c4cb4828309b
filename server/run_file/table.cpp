#include "server/run_file/table.h"

namespace evod::run_file {

std::string create_statement(const std::string& table, const std::vector<Column>& columns, std::size_t key_columns,
                             bool one_line) {
    std::vector<std::string> items;
    for (const Column& column : columns) {
        items.push_back(column.name + " " + column.type);
    }
    if (key_columns == 1) {
        const std::string type = columns.front().type.substr(0, columns.front().type.find(' '));
        items.front() = columns.front().name + " " + type + " PRIMARY KEY";
    }
    items.emplace_back("checksum INTEGER NOT NULL");
    if (key_columns > 1) {
        std::string keys;
        for (std::size_t i = 0; i < key_columns; ++i) {
            keys += (keys.empty() ? "" : ", ") + columns[i].name;
        }
        items.push_back("PRIMARY KEY (" + keys + ")");
    }
    // The line breaks of the statement are part of the file format, too: SQLite stores its text in the file.
    constexpr std::size_t line_characters_max = 118;
    std::string sql, line = "CREATE TABLE " + table + " (";
    for (std::size_t i = 0; i < items.size(); ++i) {
        const std::string item = items[i] + (i + 1 < items.size() ? "," : ") STRICT;");
        const std::string space = i == 0 ? "" : " ";
        if (!one_line && i > 0 && line.size() + space.size() + item.size() > line_characters_max) {
            sql += line + "\n";
            line = "    " + item;
        } else {
            line += space + item;
        }
    }
    return sql + line;
}

} // namespace evod::run_file
