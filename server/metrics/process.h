// Process: what the operating system reports about this process.
#pragma once

#include <pthread.h>

#include <cstdint>
#include <optional>

namespace evod::metrics {

struct Process {
    double start_time_s = 0; // seconds since 1970
    double cpu_s = 0;        // all threads, including ended ones
    std::uint64_t resident_bytes = 0, virtual_bytes = 0;
    std::uint64_t open_files = 0, open_files_max = 0;
};

/// Unknown values are 0.
Process read_process();

/// CPU time of a thread that is not yet joined; nullopt if the system does not report it.
std::optional<double> cpu_s_of(pthread_t thread);

} // namespace evod::metrics
