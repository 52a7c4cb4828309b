#include "server/commands/report.h"

#include "proto/text/number_text.h"

#include <cstdio>

namespace evod::commands {
namespace {

template <class... Values>
std::string row_text(const char* format, Values... values) {
    char text[256];
    std::snprintf(text, sizeof text, format, values...);
    return text;
}

} // namespace

std::string table_heading(bool with_island, bool is_colony) {
    return row_text("%10s%s %8s %8s %8s %8s %8s %6s %7s %8s %7s %7s %9s", "generation", with_island ? " island" : "",
                    "best", "mean", "median", "worst", "spread", "alive", "starved", "poisoned", "food", "poison",
                    "diversity") +
           (is_colony ? row_text(" %6s %6s %6s %9s", "born", "eaten", "old", "predators") : std::string{});
}

std::string table_row(const simulation::GenerationStatistics& s, bool with_island, bool is_colony) {
    const std::string island = with_island ? row_text(" %6u", s.island) : std::string{};
    std::string row = row_text("%10llu%s", static_cast<unsigned long long>(s.generation), island.c_str());
    for (const double fitness :
         {s.fitness_best, s.fitness_mean, s.fitness_median, s.fitness_worst, s.fitness_deviation}) {
        row += row_text(" %8s", text::fitness_text(fitness).c_str());
    }
    row += row_text(" %6u %7u %8u %7llu %7llu %9.4f", s.alive_count, s.starved_count, s.poisoned_count,
                    static_cast<unsigned long long>(s.food_eaten), static_cast<unsigned long long>(s.poison_eaten),
                    s.diversity);
    if (is_colony && s.colony) {
        row += row_text(" %6u %6u %6u %9u", s.colony->born_count, s.colony->eaten_count, s.colony->old_count,
                        s.predators.empty() ? 0U : s.predators.front().alive_count);
    }
    return row;
}

std::string real_time_text(double factor) {
    return row_text("%.*f × real time", factor < 0.1 ? 3 : factor < 10 ? 1 : 0, factor);
}

} // namespace evod::commands
