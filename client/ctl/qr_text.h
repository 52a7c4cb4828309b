// QR text: draws a QR code with half blocks, two rows of modules in each line of text.
//
// Threads      none.
#pragma once

#include "evod/v1/commands.pb.h"

#include <string>

namespace evod::ctl {

/// Returns the code with its quiet zone. Light modules are drawn, dark ones are blank, so a terminal must have a dark
/// background, or show colours. Empty if the code is malformed.
///
/// colored  sets the colours: white on black.
std::string qr_text(const v1::QrCode& code, bool colored);

} // namespace evod::ctl
