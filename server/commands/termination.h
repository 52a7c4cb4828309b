// Termination: ends the program after an uncaught exception. If memory or threads are exhausted, the handler logs one
// line and exits with status 3; the run files then contain every command that the server has answered. Any other
// exception is a bug: the handler prints it and aborts.
//
// Threads  the handler may run on any thread. Only the first thread that enters it ends the program.
#pragma once

namespace evod::commands {

/// Installs the handler and reserves the memory that its message needs.
void install_termination_handler();

} // namespace evod::commands
