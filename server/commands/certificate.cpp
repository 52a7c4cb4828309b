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

int make_certificate(const CertificateOptions& options) {
    if (const auto made = access::make_certificate(options.hosts, options.folder); !made) {
        return fail("evod certificate", made.error());
    }
    return 0;
}

} // namespace

void add_certificate_command(command_line::Command& app) {
    auto& command = app.add_command("certificate", "Create a key and a self-signed certificate for TLS");
    auto& options = command.keep(CertificateOptions{});
    command.add_option("host", &options.hosts, "Names and IP addresses under which clients will reach the server")
        .required();
    command.add_option("--folder", &options.folder, "Folder for evod.key and evod.crt").show_default();
    command.footer("Then: evod --tls-cert evod.crt --tls-key evod.key, and evoctl --ca evod.crt. Good for " +
                   std::to_string(access::certificate_days) + " days.");
    command.action([&] { return make_certificate(options); });
}

} // namespace evod::commands
