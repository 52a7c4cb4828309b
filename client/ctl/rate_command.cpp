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

/// Reads a file with one number per line.
std::vector<double> numbers_in(const std::string& path) {
    std::istringstream file{text_in(path, "a file of fitness values", organisms_bytes_max)};
    std::vector<double> numbers;
    for (std::string line; std::getline(file, line);) {
        line.erase(std::find_if_not(line.rbegin(), line.rend(), [](char c) { return c == '\r' || c == ' '; }).base(),
                   line.end());
        double number = 0;
        const char* const end = line.data() + line.size();
        const auto read = std::from_chars(line.data(), end, number);
        if (read.ec != std::errc{} || read.ptr != end) {
            throw Stop{ExitCode::Usage, "the fitness file " + path + " is invalid: line " +
                                            std::to_string(numbers.size() + 1) + ": got " + line +
                                            ", allowed one number per line, without a heading"};
        }
        numbers.push_back(number);
    }
    return numbers;
}

void rate(const Common& common, const RateOptions& options) {
    const std::vector<double> fitness = numbers_in(options.file);
    Caller caller{common};
    caller.need("fitness", "take fitness from clients");
    const v1::WorldInfo world = caller.world(common.world);
    const std::uint64_t generation = options.generation.value_or(world.generation());
    const std::size_t most = (caller.welcome().limits().control_frame_bytes_max() - 1024) / sizeof(double);
    v1::Response response;
    std::size_t first = 0;
    do {
        v1::Request request;
        v1::SetFitness& command = *request.mutable_set_fitness();
        command.set_world(world.name());
        command.set_generation(generation);
        command.set_island(options.island);
        command.set_first_organism(static_cast<std::uint32_t>(first));
        const std::size_t end = std::min(fitness.size(), first + most);
        command.mutable_fitness()->Add(fitness.begin() + static_cast<std::ptrdiff_t>(first),
                                       fitness.begin() + static_cast<std::ptrdiff_t>(end));
        response = caller.call(std::move(request));
        first = end;
    } while (first < fitness.size());
    print(common, response, [&] {
        const auto& missing = response.world().awaited_fitness().islands();
        const bool is_missing = std::ranges::find(missing, options.island) != missing.end();
        return "rated " + std::to_string(fitness.size()) + " organisms on island " + std::to_string(options.island) +
               ", generation " + std::to_string(generation) +
               (is_missing ? "; the island has more organisms, so send all numbers again" : "") + "\n" +
               sentence(response.world()) + "\n";
    });
}

} // namespace

void add_rate_command(command_line::Command& app, const Common& common) {
    auto& command =
        app.add_command("rate", "Give the organisms of a world with fitness=external their fitness").group("Change");
    auto& options = command.keep(RateOptions{});
    command.add_option("FILE", &options.file, "Text file with one number per line, in order of organisms").required();
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
