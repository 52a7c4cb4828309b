// Web assets: the files of the browser page, which the program contains. client/web/CMakeLists.txt makes them.
//
// Owner        the program; they exist as long as it runs.
// Threads      any; nothing changes.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace evod::network {

struct WebAsset {
    std::string_view path;  // of the URL, such as "/page.js"; the page itself is "/"
    std::string_view type;  // Content-Type
    std::string_view bytes; // compressed with gzip (RFC 1952)
    std::string etag;       // entity tag with its quotation marks; differs if the bytes differ
};

/// All files of the page. Empty if evod was built without it (CMake option EVOD_BUILD_WEB).
std::span<const WebAsset> web_assets();

/// Returns the file with the path, or nullptr if there is none.
const WebAsset* web_asset(std::string_view path);

} // namespace evod::network
