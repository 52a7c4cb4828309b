#include "server/metrics/process.h"

#include <sys/resource.h>
#include <unistd.h>

#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>

namespace evod::metrics {
namespace {

double clock_seconds(clockid_t clock) {
    timespec time{};
    return ::clock_gettime(clock, &time) == 0
               ? static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9
               : 0;
}

/// Field 22 of /proc/self/stat is the start time of the process in clock ticks since boot, see proc(5).
double start_time_s() {
    std::ifstream file{"/proc/self/stat"};
    std::string text{std::istreambuf_iterator<char>{file}, {}};
    const auto name_end = text.rfind(')'); // end of field 2, which may contain any character
    if (name_end == std::string::npos) {
        return 0;
    }
    std::istringstream fields{text.substr(name_end + 1)};
    std::string skipped;
    for (int field = 3; field < 22; ++field) {
        fields >> skipped;
    }
    double clock_ticks = 0;
    if (!(fields >> clock_ticks)) {
        return 0;
    }
    return clock_seconds(CLOCK_REALTIME) - clock_seconds(CLOCK_BOOTTIME) +
           clock_ticks / static_cast<double>(::sysconf(_SC_CLK_TCK));
}

} // namespace

Process read_process() {
    // The start time is computed once, because a second computation after a change of the clock would give another
    // result.
    static const double started = start_time_s();
    Process process{.start_time_s = started, .cpu_s = clock_seconds(CLOCK_PROCESS_CPUTIME_ID)};
    std::uint64_t virtual_pages = 0, resident_pages = 0;
    if (std::ifstream{"/proc/self/statm"} >> virtual_pages >> resident_pages) {
        const auto page_bytes = static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
        process.virtual_bytes = virtual_pages * page_bytes;
        process.resident_bytes = resident_pages * page_bytes;
    }
    std::error_code ignored;
    for (std::filesystem::directory_iterator file{"/proc/self/fd", ignored}, end; file != end;
         file.increment(ignored)) {
        ++process.open_files;
    }
    rlimit files{};
    if (::getrlimit(RLIMIT_NOFILE, &files) == 0) {
        process.open_files_max = files.rlim_cur;
    }
    return process;
}

std::optional<double> cpu_s_of(pthread_t thread) {
    clockid_t clock{};
    if (::pthread_getcpuclockid(thread, &clock) != 0) {
        return std::nullopt;
    }
    return clock_seconds(clock);
}

} // namespace evod::metrics
