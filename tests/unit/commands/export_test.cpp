// Exports and bundles of files that another model made.
#include "server/commands/export.h"
#include "tests/unit/recording/recorded_run.h"
#include "tests/unit/replay/other_model.h"

#include <gmock/gmock.h>

#include <fstream>
#include <iterator>

namespace evod::commands {
namespace {

using testing::HasSubstr;

TEST(Bundle, OfAFileOfAnotherModelSaysWhatIsLeftOut) {
    const recording::TemporaryFolder folder;
    const std::string run = folder.path() + "/w.evod", bundle = folder.path() + "/bundle";
    replay::record_other_model(run, recording::small_world()).reset();
    testing::internal::CaptureStderr();
    ExportOptions options;
    options.run = run;
    options.bundle = bundle;
    EXPECT_EQ(export_run(options), 0);
    EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("4 generations are left out"));
    const auto text_of = [&](const char* name) {
        std::ifstream file{bundle + "/" + name};
        return std::string{std::istreambuf_iterator<char>{file}, {}};
    };
    EXPECT_THAT(text_of("REPEAT.md"), HasSubstr("Of 4 generations nothing is in organisms.csv and lineage.csv"));
    for (const char* table : {"organisms.csv", "lineage.csv"}) {
        EXPECT_THAT(text_of(table), HasSubstr("\n7,1,11,")) << table;
        EXPECT_THAT(text_of(table), Not(HasSubstr("\n6,1,11,"))) << table;
    }
}

TEST(Lineage, OfAFileOfAnotherModelSaysWhatIsLeftOut) {
    const recording::TemporaryFolder folder;
    const std::string run = folder.path() + "/w.evod";
    replay::record_other_model(run, recording::small_world()).reset();
    testing::internal::CaptureStderr();
    ExportOptions options;
    options.run = run;
    options.what = "lineage";
    options.output = folder.path() + "/lineage.csv";
    EXPECT_EQ(export_run(options), 0);
    EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("4 generations are left out"));
}

} // namespace
} // namespace evod::commands
