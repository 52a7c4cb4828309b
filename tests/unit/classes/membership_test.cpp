// Membership: codes, names and tokens of the members of a class.
#include "server/classes/membership.h"

#include "server/classes/codes.h"
#include "server/classes/names.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace evod::classes {
namespace {

class MembershipTest : public testing::Test {
  protected:
    Class& made(const std::string& name) {
        Class& of = classes[name];
        of = {.name = name, .teacher = "frau_k", .world_template = ""};
        return of;
    }
    Member& joined(Class& of, const std::string& name) { return **add_member(of, name, "name", draw); }

    Classes classes;
    std::uint64_t state = 1;
    Draw draw = [this] { return state = state * 6364136223846793005ULL + 1442695040888963407ULL; };
};

TEST_F(MembershipTest, ACodeIsValidForTwentyMinutes) {
    Class& of = made("bio2");
    EXPECT_FALSE(is_open(of, 100));
    open(of, false, classes, 100, draw);
    const std::string code = of.code->letters;
    EXPECT_EQ(find_by_code(classes, code, 100), &of);
    EXPECT_EQ(find_by_code(classes, code, 100 + code_valid_s - 1), &of);
    EXPECT_EQ(find_by_code(classes, code, 100 + code_valid_s), nullptr);
    open(of, false, classes, 100 + code_valid_s - 1, draw);
    EXPECT_EQ(of.code->letters, code) << "extended";
    open(of, false, classes, 100 + 3 * code_valid_s, draw);
    EXPECT_NE(of.code->letters, code) << "a code that has ended is not valid again";
    const std::string second = of.code->letters;
    open(of, true, classes, 100 + 3 * code_valid_s, draw);
    EXPECT_NE(of.code->letters, second);
    EXPECT_EQ(find_by_code(classes, second, 100 + 3 * code_valid_s), nullptr);
}

TEST_F(MembershipTest, TwoClassesNeverShareACode) {
    open(made("a"), false, classes, 0, [] { return 7; });
    std::uint64_t next = 6;
    open(made("b"), false, classes, 0, [&] { return ++next; });
    EXPECT_NE(classes["a"].code->letters, classes["b"].code->letters);
}

TEST_F(MembershipTest, NamesAreUniqueWithoutCase) {
    Class& of = made("bio2");
    joined(of, "Anna");
    const auto refused = add_member(of, "  aNNa", "hello.join.name", draw);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().reason, base::Reason::MemberNameTaken);
    EXPECT_EQ(refused.error().violations.at(0).field, "hello.join.name");
    EXPECT_EQ(joined(of, "Änna").slug, "aenna");
    EXPECT_EQ(joined(of, "A.n.n.a").slug, "a-n-n-a");
    EXPECT_EQ(joined(of, "Anna!").slug, "anna-2");
    EXPECT_EQ(joined(of, "anna?").slug, "anna-3");
    EXPECT_EQ(joined(of, "Иван").slug, "member");
    EXPECT_EQ(joined(of, "Пётр").slug, "member-2");
}

TEST_F(MembershipTest, AClassHasAtMostSixtyFourMembers) {
    Class& of = made("bio2");
    std::set<std::string> names, worlds;
    for (std::size_t i = 0; i < members_max; ++i) {
        const Member& member = **add_member(of, "", "name", [] { return std::uint64_t{5}; });
        EXPECT_EQ(member.number, i + 1);
        names.insert(folded(member.name));
        worlds.insert(world_of(of, member));
    }
    EXPECT_EQ(names.size(), members_max);
    EXPECT_EQ(worlds.size(), members_max);
    EXPECT_EQ(add_member(of, "", "name", draw).error().reason, base::Reason::MembersMax);
}

TEST_F(MembershipTest, ARenamedMemberKeepsItsWorld) {
    Class& of = made("bio2");
    joined(of, "Anna");
    joined(of, "Ben");
    Member& anna = *find(of, 1);
    ASSERT_TRUE(rename(of, anna, "ANNA B.", "n"));
    EXPECT_EQ(anna.name, "ANNA B.");
    EXPECT_EQ(world_of(of, anna), "bio2_anna");
    EXPECT_EQ(user_of(of, anna), "bio2/anna");
    EXPECT_TRUE(rename(of, anna, "anna b.", "n")) << "its own name";
    EXPECT_EQ(rename(of, anna, "ben", "n").error().reason, base::Reason::MemberNameTaken);
    EXPECT_FALSE(rename(of, anna, "  ", "n"));
    EXPECT_EQ(joined(of, "Anna").slug, "anna-2") << "slugs are not reused";
}

TEST_F(MembershipTest, ANewTokenReplacesTheOldestOnly) {
    Class& of = made("bio2");
    joined(of, "Ben");
    Member& anna = joined(of, "Anna");
    std::vector<std::string> tokens;
    for (std::size_t i = 0; i <= member_tokens_max; ++i) {
        tokens.push_back(add_token(anna, draw));
        EXPECT_EQ(tokens.back().size(), 69u);
    }
    EXPECT_FALSE(find_by_token(classes, tokens[0]));
    for (std::size_t i = 1; i < tokens.size(); ++i) {
        const auto found = find_by_token(classes, tokens[i]);
        ASSERT_TRUE(found);
        EXPECT_EQ(found->member, &anna);
        EXPECT_EQ(found->of, &of);
    }
    EXPECT_FALSE(find_by_token(classes, ""));
    EXPECT_FALSE(find_by_token(classes, "evod_"));
}

TEST_F(MembershipTest, APersonalCodeFindsItsMember) {
    Class& of = made("bio2");
    joined(of, "Anna");
    joined(of, "Ben");
    const std::string first = renew_personal_code(*find(of, 2), draw);
    EXPECT_EQ(first.size(), 10u);
    EXPECT_EQ(find_by_personal_code(classes, first)->member->name, "Ben");
    const std::string second = renew_personal_code(*find(of, 2), draw);
    EXPECT_FALSE(find_by_personal_code(classes, first));
    EXPECT_EQ(find_by_personal_code(classes, second)->member->name, "Ben");
}

} // namespace
} // namespace evod::classes
