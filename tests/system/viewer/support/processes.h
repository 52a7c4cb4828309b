// Runs the real programs as child processes of a test. EVOD and EVOVIEW are their paths.
#pragma once

#include "client/core/connection.h"
#include "tests/support/waiting.h"

#include <gtest/gtest.h>

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace evod::viewer {

class TemporaryFolder {
  public:
    TemporaryFolder() {
        std::string name = (std::filesystem::temp_directory_path() / "evoview-XXXXXX").string();
        path_ = mkdtemp(name.data());
    }
    ~TemporaryFolder() { std::filesystem::remove_all(path_); }
    std::string file(const std::string& name) const { return (path_ / name).string(); }

  private:
    std::filesystem::path path_;
};

struct Ran {
    int status = -1;
    std::string output; // standard output and error
};

/// Runs evoview to its end.
inline Ran run_evoview(const std::string& arguments) {
    Ran ran;
    FILE* pipe = popen((std::string{EVOVIEW} + " " + arguments + " 2>&1").c_str(), "r");
    std::array<char, 256> part;
    while (std::fgets(part.data(), part.size(), pipe) != nullptr) {
        ran.output += part.data();
    }
    ran.status = WEXITSTATUS(pclose(pipe));
    return ran;
}

/// A child process. The destructor ends it and waits for its end.
class Process {
  public:
    Process(std::string program, std::vector<std::string> arguments) {
        std::array<int, 2> ends;
        EXPECT_EQ(pipe(ends.data()), 0);
        id_ = fork();
        if (id_ == 0) {
            dup2(ends[1], STDOUT_FILENO);
            dup2(ends[1], STDERR_FILENO);
            close(ends[0]);
            close(ends[1]);
            std::vector<char*> pointers{program.data()};
            for (std::string& argument : arguments) {
                pointers.push_back(argument.data());
            }
            pointers.push_back(nullptr);
            execv(program.c_str(), pointers.data());
            _exit(127);
        }
        close(ends[1]);
        output_ = fdopen(ends[0], "r");
    }
    ~Process() {
        if (id_ > 0) {
            kill(id_, SIGTERM);
            wait();
        }
        std::fclose(output_);
    }
    Process(const Process&) = delete;
    Process& operator=(const Process&) = delete;

    /// The next line of its output; empty at its end.
    std::string read_line() {
        std::array<char, 512> line{};
        return std::fgets(line.data(), line.size(), output_) == nullptr ? "" : line.data();
    }
    void terminate() { kill(id_, SIGTERM); }
    /// Its exit status; -1 if a signal ended it.
    int wait() {
        int status = 0;
        waitpid(id_, &status, 0);
        id_ = 0;
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }

  private:
    pid_t id_ = 0;
    FILE* output_ = nullptr;
};

inline evod::v1::ParameterValue choice(const std::string& name) {
    evod::v1::ParameterValue value;
    value.set_choice(name);
    return value;
}
inline evod::v1::ParameterValue count(std::uint32_t number) {
    evod::v1::ParameterValue value;
    value.set_count(number);
    return value;
}
inline evod::v1::ParameterValue real(double number) {
    evod::v1::ParameterValue value;
    value.set_real(number);
    return value;
}

/// A world to make: its name, seed, and the parameters that differ from the defaults.
struct NewWorld {
    std::string name;
    std::uint64_t seed = 7;
    std::vector<std::pair<std::string, evod::v1::ParameterValue>> parameters{};
};

/// evod on a free port, with a connection of the test. It writes no run files unless the arguments contain --data.
class RealServer {
  public:
    explicit RealServer(std::vector<std::string> arguments) : process_{EVOD, with_port(std::move(arguments))} {
        for (std::string line = process_.read_line(); !line.empty(); line = process_.read_line()) {
            if (const auto begin = line.find("listening on "); begin != std::string::npos) {
                const std::string address = line.substr(begin + 13, line.find(',', begin) - begin - 13);
                connection.emplace(
                    core::Options{.server = core::parse_endpoint(address).value(), .client_name = "a test"});
                address_ = address;
                return;
            }
        }
        ADD_FAILURE() << "evod did not start";
    }

    const std::string& address() const { return address_; }
    evod::v1::WorldInfo ask(const evod::v1::Request& request) {
        const auto response = connection->request(request, hang).value();
        EXPECT_TRUE(core::accepted(response)) << core::to_text(response.status());
        return response.has_statistics() ? response.statistics().world() : response.world();
    }
    /// world  empty: the server's choice
    evod::v1::WorldInfo state(const std::string& world = "") {
        evod::v1::Request request;
        request.mutable_get_statistics()->set_world(world);
        return ask(request);
    }

    /// Makes a world that waits, with maximum speed.
    void make_world(const NewWorld& wanted) {
        evod::v1::Request create, speed;
        auto& world = *create.mutable_create_world();
        world.set_name(wanted.name);
        world.set_seed(wanted.seed);
        for (const auto& [name, value] : wanted.parameters) {
            auto& parameter = *world.add_parameters();
            parameter.set_name(name);
            *parameter.mutable_value() = value;
        }
        ask(create);
        speed.mutable_set_speed()->set_world(wanted.name);
        speed.mutable_set_speed()->mutable_speed()->set_max(true);
        ask(speed);
    }
    /// Runs a world until it is paused at this tick.
    void run_to(const std::string& world, std::uint64_t tick) {
        evod::v1::Request run;
        run.mutable_run_until_tick()->set_world(world);
        run.mutable_run_until_tick()->set_tick(tick);
        ask(run);
        EXPECT_TRUE(wait_until([&] {
            const auto now = state(world);
            return now.tick() == tick && now.state() == evod::v1::RUN_STATE_PAUSED;
        }));
    }
    /// Runs a number of generations, until the world waits.
    void run_generations(const std::string& world, std::uint64_t generations) {
        evod::v1::Request run;
        run.mutable_run()->set_world(world);
        run.mutable_run()->set_generations(generations);
        ask(run);
        EXPECT_TRUE(wait_until([&] { return state(world).state() == evod::v1::RUN_STATE_WAITING; }));
    }

    evod::v1::ParameterSet parameters(const std::string& world = "") {
        evod::v1::Request request;
        request.mutable_get_parameters()->set_world(world);
        return connection->request(request, hang).value().parameters();
    }
    /// Ends evod. Returns its output since it began to listen.
    std::string end() {
        connection.reset();
        process_.terminate();
        std::string output;
        for (std::string line = process_.read_line(); !line.empty(); line = process_.read_line()) {
            output += line;
        }
        return output;
    }

    std::optional<core::Connection> connection;

  private:
    static std::vector<std::string> with_port(std::vector<std::string> arguments) {
        if (std::ranges::find(arguments, "--data") == arguments.end()) {
            arguments.emplace_back("--keep-nothing");
        }
        arguments.insert(arguments.end(), {"--port", "0"});
        return arguments;
    }
    Process process_;
    std::string address_;
};

} // namespace evod::viewer
