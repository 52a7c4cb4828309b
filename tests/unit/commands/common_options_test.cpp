#include "server/commands/common_options.h"

#include "server/base/instructions.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <optional>

namespace evod::commands {
namespace {

/// Sets an environment variable, or removes it. The destructor restores it.
class Variable {
  public:
    Variable(const char* name, const char* value) : name_{name} {
        if (const char* before = std::getenv(name)) {
            before_ = before;
        }
        set(value);
    }
    ~Variable() { set(before_ ? before_->c_str() : nullptr); }
    Variable(const Variable&) = delete;
    Variable& operator=(const Variable&) = delete;

  private:
    void set(const char* value) { value != nullptr ? ::setenv(name_, value, 1) : ::unsetenv(name_); }

    const char* name_;
    std::optional<std::string> before_;
};

TEST(DataFolder, IsTheStateFolderUnlessGiven) {
    const Variable state{"XDG_STATE_HOME", "/state"}, home{"HOME", "/home/anna"};
    EXPECT_EQ(data_folder_or_default("given"), "given");
    EXPECT_EQ(data_folder_or_default(""), "/state/evod");
    {
        const Variable relative{"XDG_STATE_HOME", "state"};
        EXPECT_EQ(data_folder_or_default(""), "/home/anna/.local/state/evod");
    }
    const Variable unset{"XDG_STATE_HOME", nullptr};
    EXPECT_EQ(data_folder_or_default(""), "/home/anna/.local/state/evod");
}

TEST(DataFolder, IsRequiredWithoutADefault) {
    const Variable state{"XDG_STATE_HOME", nullptr}, home{"HOME", nullptr};
    EXPECT_EQ(data_folder_or_default(""), std::nullopt);
    std::string folder;
    testing::internal::CaptureStderr();
    EXPECT_FALSE(find_data_folder(folder));
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "evod: " + std::string{no_data_folder} + "\n");
    folder = "given";
    EXPECT_TRUE(find_data_folder(folder));
    EXPECT_EQ(folder, "given");
}

TEST(InstructionsOfTheEnvironment, AreUsed) {
    const Variable instructions{"EVOD_INSTRUCTIONS", "baseline"};
    EXPECT_TRUE(use_instructions_of_environment());
    EXPECT_EQ(base::instructions(), base::Instructions::Baseline);
    base::use_instructions(base::default_instructions());
}

TEST(InstructionsOfTheEnvironment, AreRefusedIfUnknown) {
    const Variable instructions{"EVOD_INSTRUCTIONS", "mmx"};
    testing::internal::CaptureStderr();
    EXPECT_FALSE(use_instructions_of_environment());
    EXPECT_THAT(testing::internal::GetCapturedStderr(),
                testing::StartsWith("evod: EVOD_INSTRUCTIONS: got mmx, allowed on this processor baseline"));
    EXPECT_EQ(base::instructions(), base::default_instructions());
}

TEST(InstructionsOfTheEnvironment, AreOptional) {
    for (const char* none : {static_cast<const char*>(nullptr), ""}) {
        const Variable instructions{"EVOD_INSTRUCTIONS", none};
        EXPECT_TRUE(use_instructions_of_environment());
        EXPECT_EQ(base::instructions(), base::default_instructions());
    }
}

TEST(Fail, PrintsTheProgramAndEveryWrongField) {
    testing::internal::CaptureStderr();
    EXPECT_EQ(fail(base::Refusal{.message = "invalid", .violations = {{"a", "0 to 1", "2"}}}), exit_error);
    const std::string text = testing::internal::GetCapturedStderr();
    EXPECT_THAT(text, testing::StartsWith("evod: invalid"));
    EXPECT_THAT(text, testing::HasSubstr("a: got 2, allowed 0 to 1"));
    testing::internal::CaptureStderr();
    fail(base::Refusal{.message = "invalid", .violations = {{"--set a", "0 to 1", "2"}}});
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "evod: --set a: got 2, allowed 0 to 1\n");
}

} // namespace
} // namespace evod::commands
