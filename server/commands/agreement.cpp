#include "server/commands/agreement.h"

#include "server/base/packing.h"

#include <algorithm>
#include <string>
#include <vector>

namespace evod::commands {

base::Result<void> agree(const base::Result<std::string>& mine, runtime::Processes& processes) {
    if (processes.size() == 1) {
        return mine ? base::Result<void>{} : mine.error();
    }
    base::Packer packer;
    packer.add(mine.has_value());
    packer.add(mine ? base::RefusalCode::InvalidArgument : mine.error().code);
    packer.add(mine ? *mine : base::to_text(mine.error()));
    const std::vector<std::string> all = processes.gather(packer.take());
    std::string first;
    for (std::uint32_t rank = 0; rank < processes.size(); ++rank) {
        base::Unpacker unpacker{all[rank]};
        const bool sound = unpacker.next<bool>();
        const auto code = unpacker.next<base::RefusalCode>();
        const auto there = unpacker.next<std::string>();
        if (!sound) {
            return refusal(code, processes.name_of(rank) + ": " + there);
        }
        if (rank == 0) {
            first = there;
        } else if (there != first) {
            return refusal(base::RefusalCode::FailedPrecondition,
                           processes.name_of(rank) +
                               " has read other files or options, or is another build of evod, than " +
                               processes.name_of(0) + ": start all processes with the same program and files");
        }
    }
    return {};
}

bool any(bool this_one, runtime::Processes& processes) {
    const std::vector<std::string> all = processes.gather(std::string(1, this_one ? 'y' : 'n'));
    return std::ranges::find(all, "y") != all.end();
}

} // namespace evod::commands
