#include "proto/command_line/manual.h"

#include "proto/command_line/command.h"

#include <gmock/gmock.h>

namespace evod::command_line {
namespace {

using testing::HasSubstr;

TEST(Manual, ContainsEveryOptionAndCommand) {
    Command app{"lab", "lab: a laboratory", "lab 1.2"};
    std::string world, role;
    app.option_group("World");
    app.add_option("--world", &world, "World").environment("LAB_WORLD");
    app.footer("It is quiet.\nAt night too.\n\nExamples:\n  lab run    .5 \\ 3\nAfterwards, go home.");
    app.environment("LAB_ROOM", "The room, if not the first one.");
    app.add_command("token", "Tokens").add_command("add", "Adds").add_option("NAME", &role, "Name").required();
    const std::string page = manual(app);
    EXPECT_THAT(page, HasSubstr(".TH LAB 1 \"\" \"lab 1.2\" \"evod manual\"\n.SH NAME\nlab \\- a laboratory\n"));
    EXPECT_THAT(page,
                HasSubstr("It is quiet. At night too.\n.PP\nExamples:\n.RS 2\n.nf\nlab run    .5 \\e 3\n.fi\n.RE\n"
                          ".PP\nAfterwards, go home.\n"));
    EXPECT_THAT(page, HasSubstr(".SS \"World\"\n.TP\n\\fB\\-\\-world\\fR \\fITEXT\\fR\nWorld.\n"));
    EXPECT_THAT(page, HasSubstr(".SS \"token add\"\n\\fBlab token add\\fR [\\fIOPTIONS\\fR] \\fINAME\\fR\n"));
    EXPECT_THAT(page, HasSubstr("\\fBLAB_WORLD\\fR\nThe value of \\fB\\-\\-world\\fR,"));
    EXPECT_THAT(page, HasSubstr("\\fBLAB_ROOM\\fR\nThe room, if not the first one.\n"));
}

TEST(Manual, LinesAreNoRequests) {
    Command app{"lab", "lab: a laboratory", "1"};
    bool flag = false;
    app.add_flag("--old", &flag, ".evod files, 'quoted'");
    app.footer("'Quoted' is fine.");
    EXPECT_THAT(manual(app), HasSubstr("\n\\&.evod files"));
    EXPECT_THAT(manual(app), HasSubstr("\n\\&'Quoted' is fine."));
}

} // namespace
} // namespace evod::command_line
