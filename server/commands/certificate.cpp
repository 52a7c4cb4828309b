#include "server/commands/certificate.h"

#include "proto/command_line/command.h"
#include "server/access/certificate.h"

#include <iostream>

namespace evod::commands {
namespace {

struct CertificateOptions {
    std::vector<std::string> hosts;
    std::string folder = ".";
};

int make_certificate(const CertificateOptions& options) {
    if (const auto made = access::make_certificate(options.hosts, options.folder); !made) {
        std::cerr << "evod: certificate: " << to_text(made.error()) << '\n';
        return 1;
    }
    return 0;
}

} // namespace

void add_certificate_command(command_line::Command& app) {
    auto& command = app.add_command("certificate", "Make a key and a certificate of its own for TLS");
    auto& options = command.keep(CertificateOptions{});
    command.add_option("host", &options.hosts, "Names and IP addresses under which clients will reach the server")
        .required();
    command.add_option("--folder", &options.folder, "Where evod.key and evod.crt are made").show_default();
    command.footer("Then: evod --tls-cert evod.crt --tls-key evod.key, and evoctl --ca evod.crt. Good for " +
                   std::to_string(access::certificate_days) + " days.");
    command.action([&] { return make_certificate(options); });
}

} // namespace evod::commands
