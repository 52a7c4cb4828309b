// `evod certificate`: creates a key and a self-signed certificate for TLS.
#include "server/access/certificate.h"
#include "proto/command_line/command.h"
#include "server/commands/commands.h"
#include "server/commands/common_options.h"

#include <string>
#include <vector>

namespace evod::commands {
namespace {

struct CertificateOptions {
    std::vector<std::string> hosts;
    std::string folder = ".";
};

int create_certificate(const CertificateOptions& options) {
    if (const auto created = access::create_certificate(options.hosts, options.folder); !created) {
        return fail(created.error());
    }
    return 0;
}

} // namespace

void add_certificate_command(command_line::Command& app) {
    auto& command =
        app.add_command("certificate", "Create a key and a self-signed certificate for TLS").group("Access");
    auto& options = command.keep(CertificateOptions{});
    command.add_option("host", &options.hosts, "Host names and IP addresses with which clients connect to the server")
        .required();
    command.add_option("--folder", &options.folder, "Existing folder in which to create evod.key and evod.crt")
        .show_default();
    command.footer(
        "Start the server with evod --tls-cert evod.crt --tls-key evod.key, and connect with evoctl --ca evod.crt. "
        "The certificate is valid for " +
        std::to_string(access::certificate_days) + " days.");
    command.action([&] { return create_certificate(options); });
}

} // namespace evod::commands
