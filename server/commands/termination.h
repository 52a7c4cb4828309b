// Termination: how the program ends after an exception that no code caught. Out of memory or of threads, it logs one
// line and exits with status 3, because the run files are complete up to the last answered command. Any other exception
// is a fault of the program: the handler prints it and aborts.
//
// Threads  the handler may run on any thread; only the first thread that enters it ends the program.
#pragma once

namespace evod::commands {

/// Installs the handler, and reserves the memory that its message needs.
void install_termination_handler();

} // namespace evod::commands
