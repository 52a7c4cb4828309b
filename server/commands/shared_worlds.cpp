#include "server/commands/shared_worlds.h"

#include "proto/command_line/command.h"
#include "server/commands/agreement.h"
#include "server/commands/common_options.h"
#include "server/run_file/build.h"
#include "server/runtime/worker_pool.h"
#include "server/simulation/shared/leader.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <memory>

namespace evod::commands {

void add_sharing_options(command_line::Command& command, SharingOptions& options) {
    command
        .add_option("--threads", &options.threads,
                    "Number of simulation threads; default: the number of processors, divided by the number of "
                    "processes that mpirun has started on this machine")
        .check(thread_count);
    command
        .add_option("--rank-timeout", &options.rank_timeout_s,
                    "Under mpirun: seconds that the processes wait for one that does not respond, before all end")
        .check(command_line::WholeNumber{1, 1'000'000})
        .show_default();
}

int share_worlds(const std::string& command, const SharingOptions& options, bool first_may_rest,
                 const std::function<int(const SharedWork&)>& work) {
    const auto joined = runtime::join_processes(std::chrono::seconds{options.rank_timeout_s}, first_may_rest);
    if (!joined) {
        return fail(joined.error());
    }
    runtime::Processes& processes = **joined;
    const bool is_first = processes.rank() == 0;
    if (const auto agreed = agree(run_file::build_text() + "\n" + command, processes); !agreed) {
        return is_first ? fail(agreed.error()) : exit_error;
    }
    const std::size_t threads =
        options.threads.value_or(std::max<std::size_t>(default_thread_count() / processes.on_this_machine(), 1));
    if (processes.size() == 1) {
        return work({processes, nullptr, threads});
    }
    if (is_first) {
        int status = 0;
        simulation::shared::lead(processes, [&](simulation::shared::Leader& leader) {
            status = work({processes, &leader, threads});
        });
        return status;
    }
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        std::signal(signal, SIG_IGN);
    }
    const std::unique_ptr<base::Executor> executor = runtime::make_executor(threads);
    simulation::shared::follow(processes, *executor);
    return 0;
}

} // namespace evod::commands
