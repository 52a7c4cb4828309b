#include "server/console/report.h"

#include <charconv>
#include <cstdio>
#include <type_traits>

namespace evod::console {
namespace {

std::string exact(double value) {
    char text[32];
    return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

template <class... Values>
std::string formatted(const char* format, Values... values) {
    char text[256];
    std::snprintf(text, sizeof text, format, values...);
    return text;
}

} // namespace

std::string table_heading(bool with_island) {
    return formatted("%10s%s %8s %8s %8s %8s %8s %6s %7s %8s %7s %7s %9s", "generation", with_island ? " island" : "",
                     "best", "mean", "median", "worst", "spread", "alive", "starved", "poisoned", "food", "poison",
                     "diversity");
}

std::string table_row(const simulation::GenerationStatistics& s, bool with_island) {
    const std::string island = with_island ? formatted(" %6u", s.island) : std::string{};
    return formatted("%10llu%s %8.1f %8.1f %8.1f %8.1f %8.1f %6u %7u %8u %7llu %7llu %9.4f",
                     static_cast<unsigned long long>(s.generation), island.c_str(), s.fitness_best, s.fitness_mean,
                     s.fitness_median, s.fitness_worst, s.fitness_deviation, s.alive_count, s.starved_count,
                     s.poisoned_count, static_cast<unsigned long long>(s.food_eaten),
                     static_cast<unsigned long long>(s.poison_eaten), s.diversity);
}

std::string csv_heading() {
    std::string line;
    simulation::for_each_number(simulation::GenerationStatistics{}, [&](const std::string& name, auto) {
        line += (line.empty() ? "" : ",") + name;
    });
    return line;
}

std::string csv_row(const simulation::GenerationStatistics& s) {
    std::string line;
    simulation::for_each_number(s, [&](const std::string&, auto value) {
        line += line.empty() ? "" : ",";
        if constexpr (std::is_floating_point_v<decltype(value)>)
            line += exact(value);
        else
            line += std::to_string(value);
    });
    return line;
}

} // namespace evod::console
