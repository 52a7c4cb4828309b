// Exports and bundles of files of another version of the model.
#include "server/commands/export.h"
#include "tests/unit/recording/recorded_run.h"
#include "tests/unit/replay/other_model.h"

#include <gmock/gmock.h>

#include <fstream>
#include <iterator>

namespace evod::commands {
namespace {

using testing::HasSubstr;

TEST(Bundle, OfAnotherModelReportsWhatIsLeftOut) {
    const recording::TemporaryFolder folder;
    const std::string run = folder.path() + "/w.evod", bundle = folder.path() + "/bundle";
    replay::record_other_model(run, recording::small_world()).reset();
    testing::internal::CaptureStderr();
    ExportOptions options;
    options.run = run;
    options.bundle = bundle;
    EXPECT_EQ(export_run(options), 0);
    EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("4 generations are omitted"));
    const auto text_of = [&](const char* name) {
        std::ifstream file{bundle + "/" + name};
        return std::string{std::istreambuf_iterator<char>{file}, {}};
    };
    EXPECT_THAT(text_of("REPEAT.md"), HasSubstr("organisms.csv and lineage.csv lack 4 generations"));
    for (const char* table : {"organisms.csv", "lineage.csv"}) {
        EXPECT_THAT(text_of(table), HasSubstr("\n7,1,11,")) << table;
        EXPECT_THAT(text_of(table), Not(HasSubstr("\n6,1,11,"))) << table;
    }
}

TEST(Lineage, OfAnotherModelReportsWhatIsLeftOut) {
    const recording::TemporaryFolder folder;
    const std::string run = folder.path() + "/w.evod";
    replay::record_other_model(run, recording::small_world()).reset();
    testing::internal::CaptureStderr();
    ExportOptions options;
    options.run = run;
    options.what = "lineage";
    options.output = folder.path() + "/lineage.csv";
    EXPECT_EQ(export_run(options), 0);
    EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("4 generations are omitted"));
}

} // namespace
} // namespace evod::commands
