#include "server/jobs/this_thread.h"

#include <pthread.h>
#include <unistd.h>

namespace evod::jobs {

void set_up_thread(const std::string& name, int niceness) {
    pthread_setname_np(pthread_self(), name.c_str());
    if (niceness != 0) {
        // On Linux each thread has a niceness of its own. If the call fails, the thread keeps that of the process,
        // which is harmless.
        [[maybe_unused]] const int now = ::nice(niceness);
    }
}

} // namespace evod::jobs
