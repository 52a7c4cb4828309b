#include "server/network/web_assets.h"

#include <gmock/gmock.h>

#include <set>

namespace evod::network {
namespace {

TEST(WebAssets, AreThePageAndItsFiles) {
    if (web_assets().empty()) {
        GTEST_SKIP() << "built without the page";
    }
    std::set<std::string_view> paths;
    std::set<std::string> etags;
    for (const WebAsset& asset : web_assets()) {
        paths.insert(asset.path);
        etags.insert(asset.etag);
        EXPECT_THAT(asset.bytes, testing::StartsWith("\x1f\x8b")) << asset.path; // gzip
        EXPECT_THAT(asset.etag, testing::MatchesRegex("\"[0-9a-f]{16}\"")) << asset.path;
        EXPECT_EQ(web_asset(asset.path), &asset);
    }
    EXPECT_THAT(paths, testing::IsSupersetOf({"/", "/app.css", "/page.js", "/worker.js"}));
    EXPECT_EQ(etags.size(), web_assets().size());
}

TEST(WebAssets, OtherPathsHaveNone) {
    for (const char* path : {"", "/index.html", "/page.js.gz", "/../page.js"}) {
        EXPECT_EQ(web_asset(path), nullptr) << path;
    }
}

} // namespace
} // namespace evod::network
