// Registry: what it answered is in the file, whatever happens.
#include "server/classes/registry.h"

#include "evod/v1/commands.pb.h"
#include "server/classes/membership.h"
#include "server/classes/ranges.h"

#include <gtest/gtest.h>

#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

namespace evod::classes {
namespace {

namespace fs = std::filesystem;

class RegistryTest : public testing::Test {
  protected:
    RegistryTest() {
        fs::remove_all(folder);
        fs::create_directories(folder);
    }
    ~RegistryTest() override { fs::remove_all(folder); }

    Registry open() const {
        auto registry = Registry::open(Registry::File{folder, run_file::Durability::Relaxed});
        EXPECT_TRUE(registry) << to_text(registry.error());
        return *std::move(registry);
    }
    static Class made(const std::string& name, std::uint64_t seed = 1) {
        v1::CreateWorld world;
        world.set_seed(seed);
        return {
            .name = name, .teacher = "frau_k", .world_template = world.SerializeAsString(), .ranges = default_ranges()};
    }

    const std::string folder = fs::temp_directory_path() / ("registry_test_" + std::to_string(::getpid()));
    const std::string file = folder + "/classes.sqlite";
};

TEST_F(RegistryTest, WithoutClassesThereIsNoFile) {
    const Registry registry = open();
    EXPECT_TRUE(registry.classes().empty());
    EXPECT_FALSE(fs::exists(file));
}

TEST_F(RegistryTest, OnlyItsOwnerCanReadTheFile) {
    Registry registry = open();
    ASSERT_TRUE(registry.store(made("bio2")));
    for (const std::string& path : {file, file + "-wal"}) {
        struct stat about {};
        ASSERT_EQ(::stat(path.c_str(), &about), 0) << path;
        EXPECT_EQ(about.st_mode & 0777, 0600u) << path;
    }
}

TEST_F(RegistryTest, NoByteKeepsADeletedName) {
    const auto is_in_a_file = [&](const std::string& name) {
        return std::ranges::any_of(fs::directory_iterator{folder}, [&](const auto& entry) {
            std::ifstream in{entry.path(), std::ios::binary};
            return std::string{std::istreambuf_iterator{in}, {}}.find(name) != std::string::npos;
        });
    };
    Registry registry = open();
    Class of = made("bio2");
    of.members = {{.number = 1, .name = "Ada Lovelace", .slug = "a"}, {.number = 2, .name = "Bo Ek", .slug = "b"}};
    of.last_number = 2;
    ASSERT_TRUE(registry.store(of));
    EXPECT_TRUE(is_in_a_file("Ada Lovelace"));
    of.members[0].name = "x";
    ASSERT_TRUE(registry.store(of));
    EXPECT_FALSE(is_in_a_file("Ada Lovelace"));
    EXPECT_TRUE(is_in_a_file("Bo Ek"));
    ASSERT_TRUE(registry.erase("bio2"));
    EXPECT_FALSE(is_in_a_file("Bo Ek"));
}

TEST_F(RegistryTest, WithoutAFileItWorksInMemory) {
    Registry registry = *Registry::open(std::nullopt);
    ASSERT_TRUE(registry.store(made("bio2")));
    EXPECT_EQ(registry.classes().size(), 1u);
    ASSERT_TRUE(registry.erase("bio2"));
    EXPECT_TRUE(registry.classes().empty());
}

TEST_F(RegistryTest, KeepsAtMostSixteenClasses) {
    Registry registry = open();
    for (std::size_t i = 0; i < classes_max; ++i) {
        ASSERT_TRUE(registry.store(made("c" + std::to_string(i))));
    }
    EXPECT_EQ(registry.store(made("one-more")).error().reason, base::Reason::ClassesMax);
    EXPECT_TRUE(registry.store(made("c3", 9))) << "a change";
    EXPECT_EQ(open().classes(), registry.classes());
}

/// Changes a class at random, through the functions that the server uses.
class Changes {
  public:
    explicit Changes(std::uint64_t seed) : random_{seed} {}

    void apply(Registry& registry) {
        const std::string name(1, static_cast<char>('a' + random_() % 4));
        const Class* there = find(registry.classes(), name);
        if (there == nullptr) {
            v1::CreateWorld world;
            world.set_seed(random_());
            ASSERT_TRUE(registry.store({.name = name,
                                        .teacher = "t",
                                        .world_template = world.SerializeAsString(),
                                        .ranges = default_ranges()}));
            return;
        }
        if (random_() % 60 == 0) {
            ASSERT_TRUE(registry.erase(name));
            return;
        }
        Class next = *there;
        change(next, registry.classes());
        ASSERT_TRUE(registry.store(next));
    }

  private:
    void change(Class& of, const Classes& classes) {
        const Draw draw = [this] { return random_(); };
        Member* member = of.members.empty() ? nullptr : &of.members[random_() % of.members.size()];
        switch (random_() % 9) {
        case 0:
            return open(of, random_() % 2 == 0, classes, static_cast<std::int64_t>(random_() % 10'000), draw);
        case 1:
            of.code.reset();
            return;
        case 2:
            of.frozen = !of.frozen;
            of.lesson = of.frozen ? "drift" : "";
            of.member_worlds_max = 1 + static_cast<std::uint32_t>(random_() % 8);
            return;
        case 3:
            of.ranges[0].max = of.ranges[0].min + static_cast<double>(random_() % 5);
            return;
        case 4:
            if (member != nullptr) {
                member->removed = !member->removed;
                renew_personal_code(*member, draw);
            }
            return;
        case 5:
            if (member != nullptr) {
                (void)rename(of, *member, "Ö" + std::to_string(random_() % 30), "n");
            }
            return;
        case 6:
            if (member != nullptr) {
                member->joined = true;
                add_token(*member, draw);
            }
            return;
        default:
            (void)add_member(of, random_() % 2 == 0 ? "" : "n" + std::to_string(random_() % 100), "n", draw);
        }
    }

    std::mt19937_64 random_;
};

TEST_F(RegistryTest, RandomHistoriesSurviveEveryRestart) {
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        fs::remove_all(folder);
        fs::create_directories(folder);
        Changes changes{seed};
        auto registry = std::make_unique<Registry>(open());
        for (int step = 0; step < 100; ++step) {
            changes.apply(*registry);
            if (step % 17 == 0) { // the files as a killed server leaves them
                const std::string killed = folder + "-killed";
                fs::remove_all(killed);
                fs::copy(folder, killed);
                const auto restored = Registry::open(Registry::File{killed});
                ASSERT_TRUE(restored) << to_text(restored.error());
                ASSERT_EQ(restored->classes(), registry->classes()) << "seed " << seed << ", step " << step;
                fs::remove_all(killed);
            }
            if (step % 29 == 0) {
                const Classes before = registry->classes();
                registry.reset();
                registry = std::make_unique<Registry>(open());
                ASSERT_EQ(registry->classes(), before) << "seed " << seed << ", step " << step;
            }
        }
    }
}

TEST_F(RegistryTest, AFailedChangeChangesNothing) {
    {
        Registry registry = open();
        ASSERT_TRUE(registry.store(made("a")));
    }
    Registry registry = open();
    fs::permissions(file, fs::perms::none);
    fs::rename(file, file + ".away");
    fs::create_directory(file);
    EXPECT_EQ(registry.store(made("b")).error().code, base::RefusalCode::Unavailable);
    EXPECT_EQ(registry.classes().size(), 1u);
    fs::remove(file);
    fs::rename(file + ".away", file);
    fs::permissions(file, fs::perms::owner_read | fs::perms::owner_write);
    ASSERT_TRUE(registry.store(made("c")));
    EXPECT_EQ(open().classes(), registry.classes());
}

TEST_F(RegistryTest, DamageIsReportedNotRepaired) {
    {
        Registry registry = open();
        ASSERT_TRUE(registry.store(made("bio2")));
    }
    const auto refused_after = [&](const char* sql) {
        const std::string copy = folder + "/copy";
        fs::create_directory(copy);
        fs::copy(file, copy + "/classes.sqlite");
        {
            run_file::Database database{copy + "/classes.sqlite", run_file::Database::Mode::Write};
            database.run(sql);
            EXPECT_FALSE(database.failed()) << database.error();
        }
        const auto opened = Registry::open(Registry::File{copy});
        fs::remove_all(copy);
        return opened ? "" : opened.error().message;
    };
    EXPECT_EQ(refused_after("SELECT 1"), "");
    EXPECT_NE(refused_after("UPDATE class SET name = 'A_B'").find("damaged"), std::string::npos);
    EXPECT_NE(refused_after("UPDATE class SET world_template = x'ff'").find("damaged"), std::string::npos);
    EXPECT_NE(refused_after("UPDATE range SET max = 1e300").find("damaged"), std::string::npos);
    EXPECT_NE(refused_after("INSERT INTO member VALUES('bio2', 1, 'a', '../a', 0, 0, x'', NULL)").find("damaged"),
              std::string::npos);
    EXPECT_NE(refused_after("INSERT INTO member VALUES('bio3', 1, 'a', 'a', 0, 0, x'', NULL)").find("damaged"),
              std::string::npos);
    EXPECT_NE(refused_after("PRAGMA user_version = 2").find("version"), std::string::npos);
    std::ofstream{file, std::ios::binary} << std::string(8192, 'x');
    EXPECT_EQ(Registry::open(Registry::File{folder}).error().code, base::RefusalCode::DataLoss);
}

} // namespace
} // namespace evod::classes
