// Interrupt: SIGINT and SIGTERM as a wish that is asked about, so that what is under way ends in order.
//
// Threads  asked about by any.
#pragma once

namespace evod::commands {

/// From now on they end the program no more.
void mind_interrupts();
/// Whether one has come.
bool interrupted();

} // namespace evod::commands
