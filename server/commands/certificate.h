// `evod certificate`: a key and a self-signed certificate for TLS.
#pragma once

namespace evod::command_line {
class Command;
}

namespace evod::commands {

/// Its exit status: 0, or 1 with a sentence on stderr.
void add_certificate_command(command_line::Command& app);

} // namespace evod::commands
