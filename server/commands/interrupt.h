// Interrupt: SIGINT and SIGTERM set a flag. Commands that run for a long time poll the flag, so that they can end
// cleanly.
//
// Threads  any thread may poll the flag.
#pragma once

namespace evod::commands {

/// Makes SIGINT and SIGTERM set the flag instead of ending the program.
void catch_interrupts();
/// Whether SIGINT or SIGTERM has arrived.
bool interrupted();

} // namespace evod::commands
