#include "client/ctl/student_list.h"

#include <gmock/gmock.h>

#include <sstream>

namespace evod::ctl {
namespace {

using testing::ElementsAre;

Checked<std::vector<ListedStudent>> read(const std::string& text) {
    std::istringstream in{text};
    return read_students(in);
}

std::vector<std::string> faults(const std::string& text) {
    const auto students = read(text);
    return students ? std::vector<std::string>{} : students.error().lines;
}

TEST(StudentList, TakesTheFirstCellOfEachRow) {
    const auto students = read("\xef\xbb\xbfname;group\r\nAda;1\r\n\r\n\"Émile, jr\" ;2\r\n");
    ASSERT_TRUE(students);
    ASSERT_EQ(students->size(), 2u);
    EXPECT_EQ((*students)[0].name, "Ada");
    EXPECT_EQ((*students)[1].name, "Émile, jr");
    EXPECT_EQ((*students)[1].line, 4u);
    EXPECT_EQ(read("Ada\nBo")->size(), 2u) << "without a heading";
}

TEST(StudentList, NamesTheLineAndTheReason) {
    EXPECT_THAT(faults("Ada\nBo\n,1\nAda\nabcdefghijklmnopqrstuvwxy\nB\x07\n"),
                ElementsAre("line 3: the name is missing", "line 4: Ada stands in line 1 already",
                            "line 5: the name has 25 characters, allowed 1 to 24",
                            "line 6: the name contains a control character"));
    EXPECT_THAT(faults("Ada\n\"Bo"), ElementsAre("line 2: a quotation mark is not closed"));
    EXPECT_THAT(faults("name\n\n"), ElementsAre("the list contains no names"));
    EXPECT_THAT(faults("ÄÖÜäöüßÄÖÜäöüßÄÖÜäöüßÄÖÜ"), ElementsAre()) << "24 characters are 48 bytes";
}

} // namespace
} // namespace evod::ctl
