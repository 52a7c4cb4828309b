#include "client/viewer/drawing/png.h"
#include "client/viewer/shell/frame_writer.h"
#include "tests/support/temporary_folder.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>

namespace evod::viewer {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

sf::Image coloured(unsigned width, unsigned height) {
    sf::Image image;
    image.create(width, height);
    for (unsigned y = 0; y < height; ++y) {
        for (unsigned x = 0; x < width; ++x) {
            const auto part = [](unsigned number) { return static_cast<sf::Uint8>(number % 256); };
            image.setPixel(x, y, sf::Color(part(x * 7), part(y * 13), part((x ^ y) * 5)));
        }
    }
    return image;
}

void expect_same(const sf::Image& image, const sf::Image& expected) {
    ASSERT_EQ(image.getSize(), expected.getSize());
    for (unsigned y = 0; y < image.getSize().y; ++y) {
        for (unsigned x = 0; x < image.getSize().x; ++x) {
            ASSERT_EQ(image.getPixel(x, y), expected.getPixel(x, y)) << x << ", " << y;
        }
    }
}

struct FrameWriterTest : testing::Test {
    support::TemporaryFolder temporary;
    const std::filesystem::path folder = temporary.path();
};

TEST(FrameFileName, ContainsNumberAndTickAndSortsByTime) {
    EXPECT_EQ(frame_file_name(0, 0), "frame-000000-tick-0.png");
    EXPECT_EQ(frame_file_name(12, 720), "frame-000012-tick-720.png");
    EXPECT_EQ(frame_file_name(1'234'567, 5), "frame-1234567-tick-5.png");
    EXPECT_LT(frame_file_name(9, 1000), frame_file_name(10, 1001));
}

TEST(IsFilm, DependsOnTheEnding) {
    EXPECT_TRUE(is_film("a/b.mp4"));
    EXPECT_TRUE(is_film("b.webm"));
    EXPECT_FALSE(is_film("mp4"));
    EXPECT_FALSE(is_film("a.mp4/frames"));
}

TEST(Png, ReadsBackTheSamePixels) {
    for (const auto& [width, height] : {std::pair{1u, 1u}, {37u, 5u}, {200u, 130u}}) {
        const sf::Image image = coloured(width, height);
        const std::string bytes = png_of(image);
        sf::Image read;
        ASSERT_TRUE(read.loadFromMemory(bytes.data(), bytes.size()));
        expect_same(read, image);
    }
}

TEST_F(FrameWriterTest, WritesOneFilePerFrame) {
    const std::string path = (folder / "new" / "frames").string();
    const auto writer = open_frame_writer(path, 20, 10, 60);
    writer->add(coloured(20, 10), 60);
    writer->add(coloured(20, 10), 63);
    writer->finish();
    EXPECT_EQ(writer->frame_count(), 2u);
    EXPECT_FALSE(std::filesystem::exists(path + ".part"));
    sf::Image read;
    ASSERT_TRUE(read.loadFromFile(path + "/frame-000001-tick-63.png"));
    expect_same(read, coloured(20, 10));
    EXPECT_TRUE(std::filesystem::exists(path + "/frame-000000-tick-60.png"));
}

TEST_F(FrameWriterTest, UnfinishedFramesAreNotInTheFolder) {
    const std::string path = (folder / "frames").string();
    {
        const auto writer = open_frame_writer(path + "/", 20, 10, 60);
        writer->add(coloured(20, 10), 60);
        EXPECT_FALSE(std::filesystem::exists(path));
        EXPECT_TRUE(std::filesystem::exists(path + ".part/frame-000000-tick-60.png"));
    }
    EXPECT_FALSE(std::filesystem::exists(path + ".part"));
}

TEST_F(FrameWriterTest, ReplacesFramesOfAnEndedProgram) {
    const std::string path = (folder / "frames").string();
    std::filesystem::create_directories(path + ".part");
    std::ofstream{path + ".part/frame-000009-tick-9.png"} << "old";
    open_frame_writer(path, 20, 10, 60)->finish();
    EXPECT_TRUE(std::filesystem::is_empty(path));
    std::filesystem::create_directories(path + ".part");
    std::ofstream{path + ".part/letter"} << "not a frame";
    EXPECT_THAT([&] { open_frame_writer(path, 20, 10, 60); },
                ThrowsMessage<std::runtime_error>(HasSubstr("move it away")));
    EXPECT_TRUE(std::filesystem::exists(path + ".part/letter"));
}

TEST_F(FrameWriterTest, AddsFramesToAFolderWithOtherFiles) {
    std::ofstream{folder / "notes.txt"} << "mine";
    const auto writer = open_frame_writer(folder.string(), 20, 10, 60);
    writer->add(coloured(20, 10), 60);
    writer->finish();
    EXPECT_TRUE(std::filesystem::exists(folder / "notes.txt"));
    EXPECT_TRUE(std::filesystem::exists(folder / "frame-000000-tick-60.png"));
}

TEST_F(FrameWriterTest, RefusesAFolderWithAnEarlierRecording) {
    std::ofstream{folder / "frame-000000-tick-1.png"} << "old";
    EXPECT_THAT([&] { open_frame_writer(folder.string(), 20, 10, 60); },
                ThrowsMessage<std::runtime_error>(HasSubstr("earlier recording")));
}

TEST_F(FrameWriterTest, ReportsWriteErrorsWithPathAndReason) {
    EXPECT_THAT([] { write_file("/dev/full", "something"); },
                ThrowsMessage<std::runtime_error>("could not write /dev/full: No space left on device"));
    std::ofstream{folder / "file"} << "no folder";
    const std::string below = (folder / "file" / "frames").string();
    EXPECT_THAT([&] { open_frame_writer(below, 20, 10, 60); },
                ThrowsMessage<std::runtime_error>(testing::AllOf(HasSubstr(below), HasSubstr("Not a directory"))));
    const auto writer = open_frame_writer((folder / "gone").string(), 20, 10, 60);
    std::filesystem::remove(folder / "gone.part");
    EXPECT_THAT([&] { writer->add(coloured(20, 10), 7); },
                ThrowsMessage<std::runtime_error>(
                    testing::AllOf(HasSubstr("frame-000000-tick-7.png"), HasSubstr("No such file or directory"))));
}

} // namespace
} // namespace evod::viewer
