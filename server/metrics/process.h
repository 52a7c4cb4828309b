// Process: what the system says of this process.
#pragma once

#include <pthread.h>

#include <cstdint>
#include <optional>

namespace evod::metrics {

struct Process {
    double start_time_s = 0; // since 1970
    double cpu_s = 0;        // of all threads, those that have ended too
    std::uint64_t resident_bytes = 0, virtual_bytes = 0;
    std::uint64_t open_files = 0, open_files_max = 0;
};

/// What cannot be found out stays 0.
Process look_at_process();

/// Processor time of a thread that has not been joined; nullopt if the system does not say.
std::optional<double> cpu_s_of(pthread_t thread);

} // namespace evod::metrics
