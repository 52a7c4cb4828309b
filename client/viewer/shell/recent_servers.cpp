#include "client/viewer/shell/recent_servers.h"

#include "proto/files/input_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <system_error>
#include <utility>

namespace evod::viewer {

namespace {

constexpr std::size_t line_bytes_max = 300; // enough for a name of 255 bytes and a port
constexpr std::size_t lines_max = 100;
constexpr std::size_t file_bytes_max = (lines_max + 1) * (line_bytes_max + 1);

} // namespace

RecentServers::RecentServers(std::filesystem::path file) : file_{std::move(file)} {
    if (!file_.empty()) {
        read();
    }
}

void RecentServers::read() {
    std::error_code error;
    if (!std::filesystem::exists(file_, error)) {
        return;
    }
    const auto text = files::read_input(file_.string(), "a list of servers", file_bytes_max);
    if (!text) {
        problem_ = file_.string() + ": " + text.error().why + "; earlier servers are not listed";
        return;
    }
    std::istringstream in{*text};
    std::vector<std::string> read;
    std::size_t number = 0;
    for (std::string line; std::getline(in, line);) {
        ++number;
        const auto address = core::parse_endpoint(line.substr(0, line_bytes_max));
        const bool clean = std::ranges::all_of(line, [](unsigned char sign) { return std::isgraph(sign) != 0; });
        if (number > lines_max || line.size() > line_bytes_max || !clean || !address) {
            problem_ = file_.string() + ":" + std::to_string(number) + ": not an address; the file is not changed";
            return;
        }
        read.push_back(core::to_text(*address));
    }
    read.resize(std::min(read.size(), kept_max));
    addresses_ = std::move(read);
}

void RecentServers::add(const core::Endpoint& server) {
    const std::string address = core::to_text(server);
    std::erase(addresses_, address);
    addresses_.insert(addresses_.begin(), address);
    addresses_.resize(std::min(addresses_.size(), kept_max));
    if (!file_.empty() && problem_.empty()) {
        write();
    }
}

void RecentServers::write() {
    const auto failed = [&](int error) {
        problem_ = file_.string() + ": " + std::strerror(error) + "; servers are not remembered";
    };
    std::error_code error;
    std::filesystem::create_directories(file_.parent_path(), error);
    std::string text;
    for (const std::string& address : addresses_) {
        text += address + "\n";
    }
    const std::string part = file_.string() + "." + std::to_string(getpid());
    const int out = open(part.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    if (out < 0) {
        return failed(errno);
    }
    const bool whole = ::write(out, text.data(), text.size()) == static_cast<ssize_t>(text.size());
    const int why = errno;
    close(out);
    if (!whole || std::rename(part.c_str(), file_.c_str()) != 0) {
        failed(whole ? errno : why);
        unlink(part.c_str());
    }
}

} // namespace evod::viewer
