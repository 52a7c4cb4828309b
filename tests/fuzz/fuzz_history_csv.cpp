// Any text as the history of an earlier run: rows, which are written and read back the same, or a refusal.
#include "client/core/history_csv.h"

#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace evod::core;
    const auto read = read_history_csv({reinterpret_cast<const char*>(data), size});
    if (!read) {
        return 0;
    }
    const auto written = [](const HistoryCsv& history) { // with every digit; what is not a number equals nothing
        std::string text = history_heading(history.gene_names);
        for (const auto& row : history.rows) {
            text += history_line(row);
        }
        return text;
    };
    const auto again = read_history_csv(written(*read));
    if (!again || again->gene_names != read->gene_names || written(*again) != written(*read)) {
        std::abort();
    }
    return 0;
}
