// The smallest useful client: connects to a server, runs three generations and prints the fitness of each.
//
//     three_generations [HOST:PORT]
#include "client/core/connection.h"

#include <iostream>

using namespace evod;

int main(int argc, char** argv) {
    const auto endpoint = core::parse_endpoint(argc > 1 ? argv[1] : "localhost");
    if (!endpoint) {
        std::cerr << endpoint.error().what << '\n';
        return 2;
    }
    core::Connection connection{{.server = *endpoint, .client_name = "three_generations"}};
    if (const auto welcome = connection.wait_connected(); !welcome) {
        std::cerr << welcome.error().what << '\n';
        return 3;
    }

    connection.subscribe(v1::SubscribeEvents{});
    v1::Request run;
    run.mutable_run()->set_generations(3);
    const auto response = connection.request(run);
    if (!response || !core::accepted(*response)) {
        std::cerr << (response ? core::to_text(response->status()) : response.error().what) << '\n';
        return 1;
    }

    for (int generations = 0; generations < 3;) {
        const auto event = connection.wait_event(std::chrono::minutes{5});
        if (!event) {
            std::cerr << "no reply: " << connection.status().reason << '\n';
            return 3;
        }
        if (event->world() == response->world().name() && event->has_generation_finished()) {
            ++generations;
            for (const auto& island : event->generation_finished().statistics()) {
                std::cout << "generation " << island.generation() << ", island " << island.island() << ": best "
                          << island.fitness_best() << ", mean " << island.fitness_mean() << '\n';
            }
        }
    }
}
