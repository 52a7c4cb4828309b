#include "server/replay/table.h"

#include "proto/text/csv.h"
#include "server/base/assert.h"

#include <boost/json/serialize.hpp>
#include <boost/json/string.hpp>

#include <utility>

namespace evod::replay {
namespace {

std::string json_text(std::string_view text) {
    return boost::json::serialize(boost::json::string{text});
}

} // namespace

Table::Table(std::ostream& out, Format format, std::vector<std::string> columns)
    : out_{out}, format_{format}, columns_{std::move(columns)} {
    if (format_ == Format::Csv) {
        for (const std::string& column : columns_) {
            text(column);
        }
        end_row();
    } else {
        for (std::string& column : columns_) {
            column = json_text(column) + ':';
        }
    }
}

void Table::begin_field() {
    EVOD_ASSERT(column_ < columns_.size());
    if (column_ > 0) {
        line_ += ',';
    }
    if (format_ == Format::JsonLines) {
        line_ += (column_ == 0 ? "{" : "") + columns_[column_];
    }
    ++column_;
}

Table& Table::text(std::string_view value) {
    begin_field();
    line_ += format_ == Format::Csv ? text::csv_cell(value) : json_text(value);
    return *this;
}

Table& Table::json(std::string_view value) {
    if (format_ == Format::Csv) {
        return text(value);
    }
    begin_field();
    line_ += value;
    return *this;
}

Table& Table::nothing() {
    begin_field();
    line_ += format_ == Format::Csv ? "" : "null";
    return *this;
}

void Table::end_row() {
    EVOD_ASSERT(column_ == columns_.size());
    line_ += format_ == Format::Csv ? "\n" : "}\n";
    out_ << line_;
    line_.clear();
    column_ = 0;
}

} // namespace evod::replay
