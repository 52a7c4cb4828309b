// `evod verify`: simulates a stored run again and compares the result with the run file.
#include "server/replay/verify.h"
#include "proto/command_line/command.h"
#include "server/commands/commands.h"
#include "server/commands/common_options.h"
#include "server/commands/progress_line.h"
#include "server/commands/report.h"
#include "server/replay/recovery.h"
#include "server/runtime/worker_pool.h"

#include <chrono>
#include <cstddef>
#include <cstdio>
#include <iostream>
#include <mutex>
#include <optional>
#include <string>

namespace evod::commands {
namespace {

using replay::Difference;
using replay::StoredMoment;
using replay::VerifyProgress;
using Clock = std::chrono::steady_clock;

struct VerifyOptions {
    std::string run; // path of a run file
    std::size_t threads = default_thread_count();
};

std::string text_of(const StoredMoment& moment) {
    return "generation " + std::to_string(moment.generation) + ", tick " + std::to_string(moment.tick);
}

void print_difference(const std::string& path, const Difference& difference) {
    std::cerr << "evod: " << path << " differs from the run that its parameters and seed produce\n"
              << "last tick that agrees: "
              << (difference.agrees ? text_of(*difference.agrees) + ": " + difference.agreeing_part : "none") << '\n'
              << "first that differs: " << text_of(difference.differs) << ": " << difference.part << ": stored "
              << difference.stored << ", simulated again " << difference.simulated << '\n';
}

/// simulated_for  time since the simulation began.
std::string text_of(const VerifyProgress& now, std::chrono::duration<double> simulated_for) {
    if (now.ticks == 0) {
        return "reading: " + std::to_string(now.generations) + " of " + std::to_string(now.generations_in_all) +
               " generations";
    }
    const double share = static_cast<double>(now.ticks) / static_cast<double>(now.ticks_in_all);
    std::string text = std::to_string(now.ticks) + " of " + std::to_string(now.ticks_in_all) +
                       " ticks simulated again, " + std::to_string(static_cast<int>(100 * share)) + " %";
    if (simulated_for > std::chrono::seconds{2}) { // an estimate is unreliable in the first two seconds
        text += ", " + std::to_string(1 + static_cast<long>(simulated_for.count() * (1 - share) / share)) + " s left";
    }
    return text;
}

/// Prints what was compared to stdout, or the first difference to stderr. Returns the exit status.
int verify(const VerifyOptions& options) {
    const auto start = Clock::now();
    const auto file = run_file::RunFile::open_checked(options.run);
    if (!file) {
        return fail(replay::with_remedies(file.error()));
    }

    ProgressLine progress;
    std::mutex progress_mutex; // guards `progress` and simulating_since; any thread may call `progress`
    std::optional<Clock::time_point> simulating_since;
    const auto executor = runtime::make_executor(options.threads);
    const auto verified = replay::verify(**file, *executor, [&](const VerifyProgress& now) {
        const std::unique_lock lock{progress_mutex, std::try_to_lock};
        if (!lock) {
            return;
        }
        if (now.ticks > 0 && !simulating_since) {
            simulating_since = Clock::now();
        }
        progress.show([&] { return text_of(now, Clock::now() - simulating_since.value_or(Clock::now())); });
    });
    // A server would restore the world of this snapshot. The reason why it cannot comes first, in the server's words.
    const auto restored = replay::recover(**file, *executor);
    progress.clear();
    if (!restored) {
        fail(replay::with_remedies(restored.error()));
    }
    if (!verified && (restored || verified.error().message != restored.error().message)) {
        fail(replay::with_remedies(verified.error()));
    }
    if (verified && verified->difference) {
        print_difference(options.run, *verified->difference);
    }
    if (!restored || !verified || verified->difference) {
        return exit_error;
    }
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    std::printf(
        "%s: everything agrees: %llu generations, %llu ticks, %llu state hashes, %llu checkpoints compared in %.2f s, "
        "%s\n",
        options.run.c_str(), static_cast<unsigned long long>(verified->generations),
        static_cast<unsigned long long>(verified->ticks), static_cast<unsigned long long>(verified->hashes),
        static_cast<unsigned long long>(verified->checkpoints), seconds,
        real_time_text(verified->simulated_s / seconds).c_str());
    return 0;
}

} // namespace

void add_verify_command(command_line::Command& app) {
    auto& command = app.add_command("verify", "Simulate a stored run again and compare the result with the run file")
                        .group("Run files");
    auto& options = command.keep(VerifyOptions{});
    command.add_option("run", &options.run, "Run file, NAME.evod; the run may still be in progress").required();
    command.add_option("--threads", &options.threads, "Number of simulation threads")
        .check(thread_count)
        .show_default();
    command.footer("Exit status: 0 everything agrees, 1 the file differs, is damaged or cannot be simulated again.");
    command.action([&] { return verify(options); });
}

} // namespace evod::commands
