#include "client/viewer/world/freezer.h"

#include "proto/codec/population_csv.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/viewer/world/population_of.h"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <fstream>

namespace evod::viewer {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

struct FreezerTest : testing::Test {
    std::vector<std::string> names() {
        freezer.update(now += std::chrono::seconds{2});
        std::vector<std::string> names;
        for (const Frozen& file : freezer.files()) {
            names.push_back(file.name);
        }
        return names;
    }
    void write(const std::string& name, const std::string& text) const {
        std::filesystem::create_directories(freezer.folder());
        std::ofstream{freezer.folder() / name} << text;
    }

    support::TemporaryFolder folder;
    Freezer freezer{std::filesystem::path{folder.path()} / "evod" / "freezer"};
    Freezer::Clock::time_point now{};
    const std::vector<float> organism{1, 2.5f, 3, 4, 5, 0.1f};
};

TEST_F(FreezerTest, StoresAndFindsOrganismsAndPopulations) {
    EXPECT_THAT(names(), ElementsAre()) << "the folder does not exist yet";
    EXPECT_EQ(freezer.problem(), "");
    EXPECT_EQ(freezer.save("fast", population_of({organism})).value(), "fast");
    EXPECT_EQ(freezer.save("all", population_of({organism, organism})).value(), "all");
    EXPECT_THAT(names(), ElementsAre("all", "fast"));
    ASSERT_NE(freezer.find("fast"), nullptr);
    EXPECT_THAT(freezer.find("fast")->population.islands, ElementsAre(organism));
    EXPECT_TRUE(freezer.find("fast")->is_organism());
    EXPECT_EQ(freezer.find("fast")->content_text(), "1 organism");
    EXPECT_EQ(freezer.find("all")->content_text(), "2 organisms on 2 islands");
    EXPECT_EQ(freezer.find("none"), nullptr);
}

TEST_F(FreezerTest, OverwritesNoFile) {
    EXPECT_EQ(freezer.save("fast", population_of({organism})).value(), "fast");
    EXPECT_EQ(freezer.save("fast", population_of({{6, 5, 4, 3, 2, 1}})).value(), "fast-2");
    EXPECT_THAT(freezer.find("fast")->population.islands, ElementsAre(organism));
}

TEST_F(FreezerTest, RefusesUnsafeNames) {
    for (const char* name : {"", "../fast", "a/b", ".hidden", "a b"}) {
        const auto saved = freezer.save(name, population_of({organism}));
        ASSERT_FALSE(saved) << name;
        EXPECT_THAT(saved.error().what, HasSubstr("name: got \"" + std::string{name} + "\", allowed"));
    }
    EXPECT_FALSE(std::filesystem::exists(freezer.folder()));
}

TEST_F(FreezerTest, ListsDamagedFilesWithTheirReason) {
    write("cut.csv", std::string{codec::population_heading} + "\n0,0,1,2,3\n");
    write("other.txt", "not of the freezer");
    std::filesystem::create_directory(freezer.folder() / "folder.csv");
    ASSERT_EQ(mkfifo((freezer.folder() / "pipe.csv").c_str(), 0600), 0);
    EXPECT_THAT(names(), ElementsAre("cut", "folder", "pipe"));
    EXPECT_THAT(freezer.find("cut")->problem, HasSubstr("line 2: got \"0,0,1,2,3\", allowed"));
    EXPECT_EQ(freezer.find("folder")->problem, "This is a folder, not a population file");
    EXPECT_EQ(freezer.find("pipe")->problem, "This is a pipe, not a population file");
    EXPECT_EQ(freezer.find("cut")->organism_count(), 0u);
}

TEST_F(FreezerTest, NoticesChangesByOtherPrograms) {
    write("a.csv", "damaged");
    EXPECT_THAT(names(), ElementsAre("a"));
    write("a.csv", codec::population_text(population_of({organism})));
    write("b.csv", codec::population_text(population_of({organism})));
    EXPECT_THAT(names(), ElementsAre("a", "b"));
    EXPECT_EQ(freezer.find("a")->problem, "");
    std::filesystem::remove(freezer.folder() / "a.csv");
    EXPECT_THAT(names(), ElementsAre("b"));
    EXPECT_EQ(freezer.remove("b"), "");
    EXPECT_THAT(names(), ElementsAre());
}

TEST_F(FreezerTest, ReportsAFolderThatCannotBeUsed) {
    std::ofstream{folder.path() + "/file"} << "x";
    Freezer in_a_file{folder.path() + "/file/freezer"};
    EXPECT_THAT(in_a_file.save("fast", population_of({organism})).error().what, HasSubstr("file/freezer: "));
    in_a_file.update(now);
    EXPECT_THAT(in_a_file.problem(), HasSubstr("file/freezer: "));
    EXPECT_THAT(Freezer{}.save("fast", population_of({organism})).error().what, HasSubstr("--freezer FOLDER"));
}

} // namespace
} // namespace evod::viewer
