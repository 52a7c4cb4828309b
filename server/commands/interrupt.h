// Interrupt: SIGINT and SIGTERM set a flag that long-running commands poll, so that they can end in order.
//
// Threads  any thread may poll the flag.
#pragma once

namespace evod::commands {

/// From now on the two signals set the flag instead of ending the program.
void catch_interrupts();
/// Whether one of them has arrived.
bool interrupted();

} // namespace evod::commands
