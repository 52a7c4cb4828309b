// Student list: the names of members of a class in a CSV file, one in the first cell of each row. A first row "name" or
// "Name" is a heading.
//
// Threads      none.
#pragma once

#include "client/ctl/registry.h"

#include <cstddef>
#include <cstdint>
#include <istream>
#include <string>
#include <vector>

namespace evod::ctl {

struct ListedStudent {
    std::string name;       // 1 to 24 characters
    std::uint64_t line = 0; // from 1
};

/// Reads a list. Empty lines are skipped. Errors name the line: "line 3: Ada stands in line 2 already".
Checked<std::vector<ListedStudent>> read_students(std::istream& in);

} // namespace evod::ctl
