#include "server/protocol/public_text.h"

#include <algorithm>
#include <mutex>
#include <vector>

namespace evod::protocol {
namespace {

struct HiddenFolders {
    std::mutex mutex;
    std::vector<std::string> paths; // without a slash at the end; the longest first, because a folder may be in another
};

HiddenFolders& hidden_folders() {
    static HiddenFolders folders;
    return folders;
}

/// Whether the character may be part of a path. A space may be, too, but it also separates words.
bool continues_path(char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '.' || c == '_' ||
           c == '-' || c == '/' || static_cast<unsigned char>(c) >= 0x80;
}

void remove_folder(std::string& text, const std::string& folder) {
    std::size_t at = 0;
    while ((at = text.find(folder, at)) != std::string::npos) {
        const std::size_t end = at + folder.size();
        const std::size_t file = std::min(text.find_first_not_of('/', end), text.size());
        if (at > 0 && continues_path(text[at - 1])) {
            at = end; // the end of another path
        } else if (file > end && file < text.size() && continues_path(text[file])) {
            text.erase(at, file - at);
        } else if (folder.front() == '/' && (file > end || end == text.size() || !continues_path(text[end]))) {
            constexpr std::string_view instead = "the data folder";
            text.replace(at, file - at, instead);
            at += instead.size();
        } else {
            at = end;
        }
    }
}

} // namespace

void hide_folder(std::string_view path) {
    while (path.ends_with('/')) {
        path.remove_suffix(1);
    }
    HiddenFolders& folders = hidden_folders();
    const std::lock_guard lock{folders.mutex};
    if (path.empty() || std::ranges::find(folders.paths, path) != folders.paths.end()) {
        return;
    }
    folders.paths.emplace_back(path);
    std::ranges::stable_sort(folders.paths, std::greater{}, &std::string::size);
}

std::string public_text(std::string_view text) {
    std::string shown{text};
    HiddenFolders& folders = hidden_folders();
    const std::lock_guard lock{folders.mutex};
    for (const std::string& folder : folders.paths) {
        remove_folder(shown, folder);
    }
    return shown;
}

} // namespace evod::protocol
