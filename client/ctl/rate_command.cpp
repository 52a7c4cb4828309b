// The command rate: gives a world whose fitness comes from clients the fitness of an island's organisms.
#include "client/ctl/caller.h"
#include "client/ctl/input_file.h"
#include "client/ctl/text.h"
#include "proto/command_line/command.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

namespace evod::ctl {

namespace {

struct RateOptions {
    std::string file;
    std::uint32_t island = 0;
    std::optional<std::uint64_t> generation;
};

/// The numbers of a file: so many for each organism, one organism after another.
struct Ratings {
    std::vector<double> fitness;
    std::size_t objectives = 1;
};

/// Reads a file with one line per organism: one number, or several with commas or blanks between them.
Ratings ratings_in(const std::string& path) {
    std::istringstream file{text_in(path, "a file of fitness values", organisms_bytes_max)};
    Ratings ratings;
    std::size_t lines = 0;
    for (std::string line; std::getline(file, line); ++lines) {
        const auto wrong = [&](const std::string& allowed) {
            return Stop{ExitCode::Usage, "the fitness file " + path + " is invalid: line " + std::to_string(lines + 1) +
                                             ": got " + line + ", allowed " + allowed + ", without a heading"};
        };
        std::size_t count = 0;
        for (const char *at = line.data(), *const end = at + line.size(); at != end;) {
            double number = 0;
            const auto read = std::from_chars(at, end, number);
            if (read.ec != std::errc{}) {
                throw wrong("one number per line, or one for each objective");
            }
            ratings.fitness.push_back(number);
            ++count;
            at = std::find_if_not(read.ptr, end, [](char c) { return c == ',' || c == ' ' || c == '\t' || c == '\r'; });
            if (at == read.ptr && at != end) {
                throw wrong("one number per line, or one for each objective");
            }
        }
        ratings.objectives = lines == 0 ? count : ratings.objectives;
        if (count == 0 || count != ratings.objectives) {
            throw wrong(ratings.objectives <= 1
                            ? "one number per line"
                            : std::to_string(ratings.objectives) + " numbers, as in the first line");
        }
    }
    return ratings;
}

void rate(const Common& common, const RateOptions& options) {
    const Ratings ratings = ratings_in(options.file);
    const std::vector<double>& fitness = ratings.fitness;
    const std::size_t objectives = ratings.objectives;
    Caller caller{common};
    caller.need("fitness", "take fitness from clients");
    const v1::WorldInfo world = caller.world(common.world);
    const std::uint64_t generation = options.generation.value_or(world.generation());
    const std::size_t most =
        (caller.welcome().limits().control_frame_bytes_max() - 1024) / sizeof(double) / objectives * objectives;
    v1::Response response;
    std::size_t first = 0;
    do {
        v1::Request request;
        v1::SetFitness& command = *request.mutable_set_fitness();
        command.set_world(world.name());
        command.set_generation(generation);
        command.set_island(options.island);
        command.set_first_organism(static_cast<std::uint32_t>(first / objectives));
        const std::size_t end = std::min(fitness.size(), first + most);
        command.mutable_fitness()->Add(fitness.begin() + static_cast<std::ptrdiff_t>(first),
                                       fitness.begin() + static_cast<std::ptrdiff_t>(end));
        response = caller.call(std::move(request));
        first = end;
    } while (first < fitness.size());
    print(common, response, [&] {
        const auto& missing = response.world().awaited_fitness().islands();
        const bool is_missing = std::ranges::find(missing, options.island) != missing.end();
        return "rated " + std::to_string(fitness.size() / objectives) + " organisms on island " +
               std::to_string(options.island) + ", generation " + std::to_string(generation) +
               (is_missing ? "; the island has more organisms, so send all numbers again" : "") + "\n" +
               sentence(response.world()) + "\n";
    });
}

} // namespace

void add_rate_command(command_line::Command& app, const Common& common) {
    auto& command =
        app.add_command("rate", "Give the organisms of a world with fitness=external their fitness").group("Change");
    auto& options = command.keep(RateOptions{});
    command
        .add_option("FILE", &options.file,
                    "Text file with one line per organism, in order: a number, or one for each objective")
        .required();
    command.add_option("--island", &options.island, "Island, numbered from 0").check(index_number);
    command
        .add_option("--generation", &options.generation,
                    "Generation to which the numbers belong; refused if it is not the current one")
        .check(at_least_one);
    command.footer("The world waits for the numbers at the end of each generation; `evoctl status` shows it.\n"
                   "`evoctl export --what population` writes the genes of its organisms.\n"
                   "Example:\n  evoctl rate fitness.txt --generation 7");
    command.action([&] { rate(common, options); });
}

} // namespace evod::ctl
