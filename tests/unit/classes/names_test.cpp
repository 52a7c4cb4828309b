// Names and codes: what is accepted, what is made of it, and what the server makes up.
#include "server/classes/names.h"

#include "server/classes/class.h"
#include "server/classes/codes.h"
#include "server/simulation/world_name.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace evod::classes {
namespace {

std::string cleaned(const std::string& name) {
    return cleaned_member_name(name, "name").value();
}

TEST(ClassNames, BeginWithALetter) {
    for (const char* good : {"a", "bio2", "year-10", "abcdefghijklmnopqrstuvwx"}) {
        EXPECT_TRUE(is_class_name(good)) << good;
    }
    for (const char* bad : {"", "2bio", "-a", "Bio", "a_b", "a/b", "a b", "bi\xc3\xb6", "abcdefghijklmnopqrstuvwxy"}) {
        EXPECT_FALSE(is_class_name(bad)) << bad;
    }
}

TEST(MemberNames, LoseSpacesThatAreNotSeen) {
    EXPECT_EQ(cleaned("  Anna   Lena "), "Anna Lena");
    EXPECT_EQ(cleaned("\u00a0Anna\u3000Lena\u2003"), "Anna Lena");
    EXPECT_EQ(cleaned(" \u00a0 "), "");
    EXPECT_EQ(cleaned("Jürgen ß 🦊"), "Jürgen ß 🦊");
}

TEST(MemberNames, CountCharactersNotBytes) {
    std::string foxes;
    for (std::size_t i = 0; i < member_name_characters_max; ++i) {
        foxes += "🦊";
    }
    EXPECT_EQ(cleaned(foxes), foxes);
    const auto refused = cleaned_member_name(foxes + "a", "hello.join.name");
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().violations.at(0).field, "hello.join.name");
    EXPECT_EQ(refused.error().violations.at(0).got, "25 characters");
    EXPECT_EQ(cleaned_member_name(std::string(5000, 'a'), "n").error().violations.at(0).got, "5000 bytes");
}

TEST(MemberNames, RefuseWhatCannotBeSeen) {
    for (const char* bad : {"a\nb", "a\tb", "\x7f", "a\u0085", "a\u00adb", "a\u200bb", "a\u200eb", "\u202eb",
                            "a\u2066b", "a\ufeffb", "a\u3164", "\ufe0f", "a\u2028b", "\U000e0041", "\u2800"}) {
        EXPECT_FALSE(cleaned_member_name(bad, "n")) << bad;
    }
    EXPECT_EQ(cleaned_member_name("a\u202eb", "n").error().violations.at(0).got, "the character U+202E");
    for (const char* bad : {"\xff", "a\xc3", "\xed\xa0\x80", "\xc0\x80", "\xf5\x80\x80\x80"}) {
        EXPECT_EQ(cleaned_member_name(bad, "n").error().violations.at(0).got, "bytes that are not UTF-8") << bad;
    }
}

TEST(MemberNames, AreEqualWithoutCase) {
    EXPECT_EQ(folded("ANNA Öz"), folded("anna öZ"));
    EXPECT_EQ(folded("ŁUKASZ ŽIŽEK"), folded("łukasz žižek"));
    EXPECT_EQ(folded("ИВАН Ё"), folded("иван ё"));
    EXPECT_EQ(folded("ΑΛΕΞ"), folded("αλεξ"));
    EXPECT_NE(folded("anna"), folded("änna"));
    EXPECT_EQ(folded("×÷"), "×÷");
}

TEST(Slugs, ArePartsOfNamesOfWorlds) {
    EXPECT_EQ(slug_of("Red Fox"), "red-fox");
    EXPECT_EQ(slug_of("Jürgen Weiß"), "juergen-weiss");
    EXPECT_EQ(slug_of("ÉLÈVE no. 7!"), "eleve-no-7");
    EXPECT_EQ(slug_of("Иван"), "member");
    EXPECT_EQ(slug_of("../../etc"), "etc");
    EXPECT_EQ(slug_of("ÖÖÖÖÖÖÖÖÖÖÖÖÖÖÖÖÖÖÖÖÖÖÖÖ").size(), 24u);
    const Class of{.name = "abcdefghijklmnopqrstuvwx", .teacher = "", .world_template = ""};
    const Member member{.number = 1, .name = "", .slug = slug_of("ÖÖÖÖÖÖÖÖÖÖÖÖÖÖÖÖÖÖÖÖÖÖÖÖ") + "-64"};
    EXPECT_TRUE(simulation::is_world_name(world_of(of, member) + "_fork"));
}

TEST(MadeUpNames, AreManyAndTheirOwnSlugs) {
    std::set<std::string> names;
    for (std::size_t i = 0; i < made_up_names; ++i) {
        const std::string name = made_up_name(i);
        EXPECT_EQ(slug_of(name), name);
        EXPECT_LE(name.size(), member_name_characters_max);
        names.insert(name);
    }
    EXPECT_EQ(names.size(), 64u * 64u);
    EXPECT_EQ(made_up_name(made_up_names), made_up_name(0));
}

TEST(Codes, HaveLettersWithoutVowels) {
    EXPECT_EQ(code_of(0, 6), "BBBBBB");
    EXPECT_EQ(code_of(19, 6), "ZBBBBB");
    EXPECT_EQ(code_of(~0ULL, 10).size(), 10u);
    for (const char vowel : std::string{"AEIOUY"}) {
        EXPECT_EQ(code_letters.find(vowel), std::string_view::npos);
    }
}

TEST(Codes, AreReadAsPeopleWriteThem) {
    EXPECT_EQ(normalised_code("ktr-mxb"), "KTRMXB");
    EXPECT_EQ(normalised_code(" KTR MXB "), "KTRMXB");
    EXPECT_EQ(normalised_code("bcdfg hjklm"), "BCDFGHJKLM");
    for (const char* bad : {"", "KTRMX", "KTRMXBB", "KTRMXA", "KTRMX1", "KTRMXB\n", "БББЬЬЬ", "BCDFGHJKLMN"}) {
        EXPECT_EQ(normalised_code(bad), std::nullopt) << bad;
    }
    EXPECT_EQ(normalised_code(std::string(100'000, 'B')), std::nullopt);
    EXPECT_TRUE(same_code("KTRMXB", "KTRMXB"));
    EXPECT_FALSE(same_code("KTRMXB", "KTRMXC"));
    EXPECT_FALSE(same_code("KTRMXB", "KTRMX"));
}

} // namespace
} // namespace evod::classes
