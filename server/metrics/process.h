// Process: reads the operating system's statistics about this process.
#pragma once

#include <pthread.h>

#include <cstdint>
#include <optional>

namespace evod::metrics {

struct Process {
    double start_time_s = 0; // seconds since 1970
    double cpu_s = 0;        // CPU time of all threads, including threads that have ended
    std::uint64_t resident_bytes = 0, virtual_bytes = 0;
    std::uint64_t open_files = 0, open_files_max = 0;
};

/// Reads the current values. Values that the system does not report are 0.
Process read_process();

/// CPU time of a thread that has not been joined; nullopt if the system does not report it.
std::optional<double> cpu_s_of(pthread_t thread);

} // namespace evod::metrics
