// `evod check`: validates an experiment file without running it, or compares the integrators with an exact solution.
#include "proto/command_line/command.h"
#include "server/commands/commands.h"
#include "server/commands/common_options.h"
#include "server/experiments/experiment_file.h"
#include "server/parameters/warnings.h"
#include "server/physics/constant_acceleration.h"

#include <cmath>
#include <cstdio>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

namespace evod::commands {
namespace {

/// Prints the parameters that the file changes, or the errors in it. Returns the exit status.
int check(const std::string& path) {
    const base::Result<parameters::Experiment> experiment = experiments::load_experiment(path);
    if (!experiment) {
        return fail(experiment.error());
    }
    std::vector<std::string> warnings = parameters::warnings_of(experiment->parameters);
    if (auto warning = warning_about(experiment->seed)) {
        warnings.push_back(*std::move(warning));
    }
    std::cout << path << ": valid";
    if (!experiment->description.empty()) {
        std::cout << "\n" << experiment->description;
    }
    const std::string changes =
        parameters::to_experiment_text(experiment->parameters, parameters::Written::Differences, experiment->schedule);
    if (changes == "{}\n") {
        std::cout << "\nEvery parameter has its default.\n";
    } else {
        std::cout << "\nParameters that differ from their defaults:\n" << changes;
    }
    for (const std::string& warning : warnings) {
        std::cout << "warning: " << warning << "\n";
    }
    return 0;
}

/// Prints the position and the error of each integrator for five tick lengths. Returns the exit status.
int check_integrators() {
    using physics::Integrator;
    constexpr double a = 2, t = 2.4, exact_m = a * t * t / 2, speed_m_s = a * t;
    std::printf("A body accelerates from rest at a = %g m/s² for t = %g s, without damping.\n"
                "Exact: position ½at² = %.3f m, speed at = %.3f m/s\n\n",
                a, t, exact_m, speed_m_s);
    std::printf("                explicit Euler      symplectic Euler     both\n"
                "tick   ticks   position    error   position    error    speed\n"
                "   s                  m        m          m        m      m/s\n");
    for (const double tick_s : {0.8, 0.4, 0.2, 0.1, 0.05}) {
        const int ticks = static_cast<int>(std::lround(t / tick_s));
        const auto explicit_euler = physics::accelerate_from_rest(Integrator::ExplicitEuler, a, tick_s, ticks);
        const auto symplectic = physics::accelerate_from_rest(Integrator::SymplecticEuler, a, tick_s, ticks);
        std::printf("%.2f %7d %10.3f %+8.3f %10.3f %+8.3f %8.3f\n", tick_s, ticks, explicit_euler.position_m,
                    explicit_euler.position_m - exact_m, symplectic.position_m, symplectic.position_m - exact_m,
                    symplectic.speed_m_s);
    }
    std::printf(
        "\nThe error of the position is −½·a·t·tick for explicit Euler and +½·a·t·tick for symplectic Euler.\n");
    return 0;
}

} // namespace

void add_check_command(command_line::Command& app) {
    auto& command =
        app.add_command("check", "Check an experiment file and print the parameters that it changes, or check the "
                                 "integrators")
            .group("Experiments");
    auto& path = command.keep(std::string{});
    auto& integrators = command.keep(false);
    const auto file = command.add_option("experiment", &path, "Experiment file (JSON)");
    command
        .add_flag("--integrators", &integrators,
                  "Print the errors of explicit and symplectic Euler for five tick lengths; takes no experiment file")
        .excludes(file);
    command.action([&, file] {
        if (integrators) {
            return check_integrators();
        }
        return file.is_given() ? check(path) : app.reject("experiment: required unless --integrators is given");
    });
}

} // namespace evod::commands
