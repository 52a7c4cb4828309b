// Older run file: what makes of a run file what an evod of before would have left, for whoever tries how it is read.
#pragma once

#include <string>

namespace evod::support {

/// SQL for a file of the present format, whose checkpoints are in one part each.
///
/// format  1 to 3; docs/RUN_FILE.md tells what each had.
inline std::string as_of_format(int format) {
    std::string sql = "DROP TABLE checkpoint_part; DROP TABLE selection_account;"
                      "DELETE FROM run WHERE key = 'schedule';";
    if (format < 3) {
        sql += "DROP TABLE founders; DROP TABLE inherited_statistics;"
               "DELETE FROM run WHERE key = 'inherited_generations';";
    }
    if (format < 2) {
        sql += "DROP TABLE checkpoint; DELETE FROM run WHERE key = 'first_tick';";
    }
    return sql + "PRAGMA user_version = " + std::to_string(format);
}

} // namespace evod::support
