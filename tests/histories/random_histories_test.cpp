// Random histories: whatever happens to a server, its worlds, files and answers equal those of worlds that were never
// stopped. A failure prints the seed, all actions and the first difference; HISTORIES_SEED=SEED HISTORIES=1 repeats it.
#include "server/log/log.h"
#include "server/protocol/commands.h"
#include "tests/histories/history.h"
#include "tests/support/everyday.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <variant>

namespace evod::histories {
namespace {

constexpr std::uint64_t failures_shown = 3;

const std::string* played = nullptr; // the actions of the present history

void print(const std::string& text) {
    [[maybe_unused]] const auto written = ::write(STDERR_FILENO, text.data(), text.size());
}

/// A failed assertion of the server ends the program; this prints the history that caused it.
void on_abort(int) {
    if (played != nullptr) {
        print(*played);
    }
}

TEST(RandomHistories, EqualUndisturbedTwins) {
    log::begin(log::Level::Error, log::Format::Text);
    (void)std::signal(SIGABRT, on_abort);
    const std::uint64_t first = everyday_size("HISTORIES_SEED", 1), count = everyday_size("HISTORIES", 30);
    std::uint64_t failures = 0;
    for (std::uint64_t seed = first; seed < first + count && failures < failures_shown; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        History history{seed};
        played = &history.actions();
        if (const auto failure = history.play()) {
            ++failures;
            ADD_FAILURE() << "seed " << seed << '\n' << *failure;
        }
        played = nullptr;
    }
}

/// When a parameter is set.
enum class Moment { Now, AtGeneration, AtTick };

TEST(RandomCommands, IncludeEveryCommandAndParameter) {
    std::set<std::size_t> commands;
    std::set<std::pair<std::string, Moment>> set;
    Draws draws{1};
    RandomCommands random{draws};
    Twins twins;
    std::uint64_t runs = 0;
    for (int batch = 0; batch < 20'000; ++batch) {
        for (const v1::Request& request : random.next(twins)) {
            const auto command = protocol::to_command(request, {.seed = {}, .run_id = {++runs, 1}});
            ASSERT_TRUE(command) << to_text(command.error());
            if (!twins.apply(*command)) {
                continue;
            }
            commands.insert(command->index());
            const auto* change = std::get_if<simulation::SetParameters>(&*command);
            for (const auto& assignment : change ? change->assignments : std::vector<parameters::Assignment>{}) {
                set.emplace(assignment.name, !change->at              ? Moment::Now
                                             : change->at->generation ? Moment::AtGeneration
                                                                      : Moment::AtTick);
            }
        }
        for (const auto& entry : twins.laboratory().entries()) {
            (void)twins.advance(entry->name, entry->world.moment().tick + draws.below(2));
        }
    }
    for (std::size_t index = 0; index < std::variant_size_v<simulation::Command>; ++index) {
        EXPECT_TRUE(commands.contains(index)) << "number " << index << " of simulation::Command";
    }
    for (const parameters::ParameterDescription& description : parameters::parameter_registry()) {
        const std::string name{description.name};
        EXPECT_TRUE(set.contains({name, Moment::Now})) << name << " now";
        if (parameters::can_be_scheduled(description)) {
            EXPECT_TRUE(set.contains({name, Moment::AtGeneration})) << name << " at a generation";
            EXPECT_TRUE(set.contains({name, Moment::AtTick})) << name << " at a tick";
        }
    }
}

} // namespace
} // namespace evod::histories
