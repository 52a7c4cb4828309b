// The real programs, as children of a test. EVOD and EVOVIEW are their paths.
#pragma once

#include "client/link/connection.h"

#include <gtest/gtest.h>

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace evod::viewer {

/// Waits for it; false if it does not come within some seconds.
template <class Condition>
bool comes_true(Condition condition) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds{20};
    while (!condition()) {
        if (std::chrono::steady_clock::now() > end) {
            return false;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds{10});
    }
    return true;
}

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
    std::string output; // both of them
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

/// A program that runs beside the test; its end is waited for.
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

    /// The next line of what it says; empty at its end.
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

/// evod on a port of its own, with a connection of the test's own. It keeps nothing unless it is told --data.
class RealServer {
  public:
    explicit RealServer(std::vector<std::string> arguments) : process_{EVOD, with_port(std::move(arguments))} {
        for (std::string line = process_.read_line(); !line.empty(); line = process_.read_line()) {
            if (const auto begin = line.find("listening on "); begin != std::string::npos) {
                const std::string address = line.substr(begin + 13, line.find(',', begin) - begin - 13);
                connection.emplace(
                    link::Options{.server = link::parse_endpoint(address).value(), .client_name = "a test"});
                address_ = address;
                return;
            }
        }
        ADD_FAILURE() << "evod did not start";
    }

    const std::string& address() const { return address_; }
    evod::v1::WorldInfo ask(const evod::v1::Request& request) {
        const auto response = connection->request(request).value();
        EXPECT_TRUE(link::accepted(response)) << link::to_text(response.status());
        return response.has_statistics() ? response.statistics().world() : response.world();
    }
    evod::v1::WorldInfo state() {
        evod::v1::Request request;
        request.mutable_get_statistics();
        return ask(request);
    }

    evod::v1::ParameterSet parameters() {
        evod::v1::Request request;
        request.mutable_get_parameters();
        return connection->request(request).value().parameters();
    }
    /// Ends it; everything that it has said since it began to listen.
    std::string end() {
        connection.reset();
        process_.terminate();
        std::string said;
        for (std::string line = process_.read_line(); !line.empty(); line = process_.read_line()) {
            said += line;
        }
        return said;
    }

    std::optional<link::Connection> connection;

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
