#include "server/console/report.h"

#include "server/evolution/chromosome.h"

#include <charconv>
#include <cstdio>

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
    std::string line = "generation,island,end_tick,simulated_s,organism_count,fitness_best,fitness_mean,fitness_median,"
                       "fitness_worst,fitness_deviation,diversity,alive_count,starved_count,poisoned_count,food_eaten,"
                       "poison_eaten,clamp_count,too_fast_count,speed_limit_count,best_organism";
    for (const std::string_view gene : evolution::gene_names)
        for (const char* statistic : {"_mean", "_deviation", "_min", "_max"})
            line += "," + std::string{gene} + statistic;
    return line;
}

std::string csv_row(const simulation::GenerationStatistics& s) {
    std::string line = std::to_string(s.generation);
    const auto count = [&](std::uint64_t value) { line += "," + std::to_string(value); };
    const auto real = [&](double value) { line += "," + exact(value); };
    count(s.island);
    count(s.end_tick);
    real(s.simulated_s);
    count(s.organism_count);
    real(s.fitness_best);
    real(s.fitness_mean);
    real(s.fitness_median);
    real(s.fitness_worst);
    real(s.fitness_deviation);
    real(s.diversity);
    count(s.alive_count);
    count(s.starved_count);
    count(s.poisoned_count);
    count(s.food_eaten);
    count(s.poison_eaten);
    count(s.clamp_count);
    count(s.too_fast_count);
    count(s.speed_limit_count);
    count(s.best_organism);
    for (const simulation::GeneStatistics& gene : s.genes) {
        real(gene.mean);
        real(gene.deviation);
        real(gene.min);
        real(gene.max);
    }
    return line;
}

} // namespace evod::console
