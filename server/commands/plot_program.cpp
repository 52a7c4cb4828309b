#include "server/commands/plot_program.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <vector>

namespace evod::commands {
namespace {

using base::RefusalCode;

/// The path of the script: in the folder of the program, or where it is installed; empty if the folder is unknown.
std::string script_path() {
    std::error_code error;
    const auto folder = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
    if (error) {
        return {};
    }
    const auto built = folder / "plot_compare";
    return std::filesystem::exists(built, error) ? built.string()
                                                 : (folder.parent_path() / "libexec/evod/plot_compare").string();
}

/// Runs the script with these arguments. The script prints its own errors to stderr.
base::Result<void> run_script(std::vector<std::string> words) {
    words.insert(words.begin(), script_path());
    std::vector<char*> arguments;
    for (std::string& word : words) {
        arguments.push_back(word.data());
    }
    arguments.push_back(nullptr);
    pid_t process = 0;
    if (const int error = ::posix_spawn(&process, arguments[0], nullptr, nullptr, arguments.data(), environ);
        error != 0) {
        return refusal(RefusalCode::FailedPrecondition, "cannot run " + words[0] + ": " + std::strerror(error) +
                                                            "; it needs the packages python3 and python3-matplotlib");
    }
    int status = 0;
    while (::waitpid(process, &status, 0) < 0) {
        if (errno != EINTR) {
            return refusal(RefusalCode::Unavailable, words[0] + ": " + std::strerror(errno));
        }
    }
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
        return refusal(RefusalCode::FailedPrecondition, words[0] + " failed, see its message above");
    }
    return {};
}

} // namespace

base::Result<void> check_plot_program() {
    return run_script({"--check"});
}

base::Result<void> draw_curves(const std::string& curves, const std::string& title, const std::string& subtitle,
                               const std::string& y_label, const std::string& path) {
    return run_script({curves, path, "--title", title, "--subtitle", subtitle, "--y-label", y_label});
}

} // namespace evod::commands
