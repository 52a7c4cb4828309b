#include "server/network/web_assets.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#ifdef EVOD_WEB

// client/web/assets.S defines each file as NAME and its end as NAME_end.
#define WEB_FILE(name, path, type, file) extern "C" const char name[], name##_end[];
#include <web_files.inc>
#undef WEB_FILE

#endif

namespace evod::network {
namespace {

#ifdef EVOD_WEB

WebAsset asset(std::string_view path, std::string_view type, const char* begin, const char* end) {
    // The last eight bytes of a gzip file are the CRC-32 and the size of its content.
    constexpr std::ptrdiff_t trailer_bytes = 8;
    std::string etag = "\"";
    for (const char* byte = end - trailer_bytes; byte != end; ++byte) {
        constexpr std::string_view digits = "0123456789abcdef";
        etag += digits[static_cast<unsigned char>(*byte) >> 4];
        etag += digits[static_cast<unsigned char>(*byte) & 15];
    }
    return {.path = path, .type = type, .bytes = {begin, end}, .etag = etag + "\""};
}

const std::vector<WebAsset>& all_assets() {
    static const std::vector<WebAsset> all = {
#define WEB_FILE(name, path, type, file) asset(path, type, name, name##_end),
#include <web_files.inc>
#undef WEB_FILE
    };
    return all;
}

#else

const std::vector<WebAsset>& all_assets() {
    static const std::vector<WebAsset> none;
    return none;
}

#endif

} // namespace

std::span<const WebAsset> web_assets() {
    return all_assets();
}

const WebAsset* web_asset(std::string_view path) {
    const auto found = std::ranges::find(web_assets(), path, &WebAsset::path);
    return found == web_assets().end() ? nullptr : &*found;
}

} // namespace evod::network
