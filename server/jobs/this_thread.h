// This thread: name and priority of the calling thread.
#pragma once

#include <string>

namespace evod::jobs {

/// Sets the name of the calling thread, which `top -H` shows, and lowers its priority.
///
/// name      at most 15 characters.
/// niceness  is added to that of the process. With 7, the thread gets a sixth of a processor next to a busy thread of
///           the simulation; with 10, a tenth. Threads that it starts inherit it.
void set_up_thread(const std::string& name, int niceness = 0);

} // namespace evod::jobs
