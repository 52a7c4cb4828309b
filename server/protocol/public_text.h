// Public text: texts of the server as clients may read them, without the folders of the server's files.
//
// Messages about files name them with their paths, for the log and the terminal. A client sees only the name of the
// file, because every role may read refusals and the state of the disk.
//
// Threads      any; the hidden folders are one list of the process, because refusals are created on several threads.
#pragma once

#include <string>
#include <string_view>

namespace evod::protocol {

/// Removes this folder from all later public texts. The path must be written as in the texts.
void hide_folder(std::string_view path);

/// Returns the text without the hidden folders: "/srv/lab/w.evod is damaged" becomes "w.evod is damaged". An absolute
/// path of a hidden folder itself becomes "the data folder".
std::string public_text(std::string_view text);

} // namespace evod::protocol
