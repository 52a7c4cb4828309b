#include "server/run_file/run_database.h"

namespace evod::run_file {

using base::RefusalCode;

base::Refusal RunDatabase::failure() const {
    if (database.damaged()) {
        return refusal(RefusalCode::DataLoss, path + " is damaged or is not a run file: " + database.error());
    }
    return refusal(RefusalCode::Unavailable, path + ": " + database.error());
}

base::Refusal RunDatabase::damaged(const std::string& what) const {
    if (database.failed()) {
        return failure();
    }
    return refusal(RefusalCode::DataLoss, path + " is damaged: " + what + " is missing or was changed");
}

std::string row_text(const std::string& table, std::uint64_t key) {
    return "the row " + std::to_string(key) + " of its table " + table;
}

} // namespace evod::run_file
