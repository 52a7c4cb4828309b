#include "server/runtime/processes.h"

#include "server/runtime/mpi_component.h"

#include <dlfcn.h>

#include <cstdlib>
#include <filesystem>
#include <string_view>
#include <vector>

namespace evod::runtime {
namespace {

class Alone final : public Processes {
  public:
    std::uint32_t rank() const override { return 0; }
    std::uint32_t size() const override { return 1; }
    std::vector<std::string> gather(std::string part) override { return {std::move(part)}; }
    std::vector<std::string> swap(std::vector<std::string> parts) override { return parts; }
    std::string broadcast(std::string from_first) override { return from_first; }
    std::uint32_t on_this_machine() const override { return 1; }
    std::string name_of(std::uint32_t) const override { return "this process"; }
    double exchange_s() const override { return 0; }
};

base::Refusal unusable(const std::string& why) {
    return refusal(base::RefusalCode::FailedPrecondition,
                   "this process is one of several that mpirun has started, but " + why +
                       ". Without it, every process would do the same work. Build evod with -DEVOD_BUILD_MPI=ON, or "
                       "start it without mpirun");
}

} // namespace

bool is_one_of_several() {
    const auto value = [](const char* name) -> std::string_view {
        const char* const text = std::getenv(name);
        return text == nullptr ? "" : text;
    };
    const std::string_view open_mpi = value("OMPI_COMM_WORLD_SIZE"), pmi = value("PMI_SIZE");
    if (!open_mpi.empty() || !pmi.empty()) {
        return (!open_mpi.empty() && open_mpi != "1") || (!pmi.empty() && pmi != "1");
    }
    return !value("PMIX_RANK").empty() && value("SLURM_STEP_NUM_TASKS") != "1"; // srun --mpi=pmix
}

base::Result<std::unique_ptr<Processes>> join_processes(std::chrono::seconds patience, bool first_may_rest) {
    if (!is_one_of_several()) {
        return std::unique_ptr<Processes>{std::make_unique<Alone>()};
    }
    std::error_code ignored; // without the path of this program, dlopen() reports an error
    const auto component = std::filesystem::read_symlink("/proc/self/exe", ignored).parent_path() / "evod_mpi.so";
    void* const library = ::dlopen(component.c_str(), RTLD_NOW | RTLD_GLOBAL); // stays loaded until the process ends
    if (library == nullptr) {
        return unusable("the component evod_mpi cannot be loaded: " + std::string{::dlerror()});
    }
    const auto version = reinterpret_cast<decltype(&evod_mpi_version)>(::dlsym(library, "evod_mpi_version"));
    const auto join = reinterpret_cast<decltype(&evod_mpi_join)>(::dlsym(library, "evod_mpi_join"));
    if (version == nullptr || join == nullptr || std::string_view{version()} != EVOD_VERSION) {
        return unusable(component.string() + " is not the component of evod " EVOD_VERSION);
    }
    return std::unique_ptr<Processes>{join(patience.count(), first_may_rest)};
}

} // namespace evod::runtime
