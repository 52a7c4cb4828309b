// evoctl top: shows the server's metrics live.
#include "client/ctl/caller.h"
#include "client/ctl/screen.h"
#include "client/ctl/top.h"
#include "proto/command_line/command.h"

#include <algorithm>
#include <chrono>
#include <iostream>
#include <optional>
#include <utility>

namespace evod::ctl {

namespace {

using Clock = std::chrono::steady_clock;

struct Options {
    double interval_s = 1;
    bool once = false;
};

class Top {
  public:
    Top(const Common& common, const Options& options)
        : common_{common}
        , options_{options}
        , caller_{common}
        , redraw_{on_terminal() && !common.json && !options.once} {}

    void run() {
        catch_interrupts();
        look();
        if (common_.json && options_.once) {
            std::cout << to_json(last_->metrics);
            return;
        }
        while (!interrupted()) {
            wait();
            if (!interrupted() && look()) {
                print();
                if (options_.once) {
                    return;
                }
            }
        }
    }

  private:
    struct Look {
        v1::Metrics metrics;
        Clock::time_point at;
    };

    /// Measures the metrics once. Returns whether the server answered. A missing answer during a reconnection is not an
    /// error.
    bool look() {
        v1::Request request;
        request.mutable_get_metrics();
        if (options_.once || !last_) {
            note(caller_.call(std::move(request)));
            return true;
        }
        const auto response = caller_.connection().request(std::move(request), caller_.timeout());
        reporter_.report(caller_.connection(), live_text_);
        if (!response) {
            return false;
        }
        if (!core::accepted(*response)) {
            throw Stop{ExitCode::Refused, core::to_text(response->status())};
        }
        note(*response);
        return true;
    }

    void note(const v1::Response& response) { before_ = std::exchange(last_, Look{response.metrics(), Clock::now()}); }

    void wait() {
        const auto until = Clock::now() + std::chrono::duration<double>{options_.interval_s};
        while (!interrupted() && Clock::now() < until) {
            // Short waits, so that evoctl reacts to Ctrl-C within a tenth of a second.
            const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now());
            caller_.connection().wait_event(
                std::clamp(left, std::chrono::milliseconds{0}, std::chrono::milliseconds{100}));
            reporter_.report(caller_.connection(), live_text_);
        }
    }

    void print() {
        if (common_.json) {
            std::cout << to_json(last_->metrics, false) << std::flush;
            return;
        }
        const std::chrono::duration<double> between = last_->at - before_->at;
        const std::chrono::duration<double> now = std::chrono::system_clock::now().time_since_epoch();
        const std::string last_line = redraw_ ? "\nCtrl-C ends evoctl, not the server\n" : "";
        const std::size_t lines = redraw_ ? terminal_size().lines : all_lines;
        const std::string text =
            top_text({before_->metrics, last_->metrics, std::max(between.count(), 1e-3)}, common_.server, now.count(),
                     lines - std::min<std::size_t>(lines, 3)) + // space for the last line and the cursor
            last_line;
        if (redraw_) {
            live_text_.draw(text);
        } else {
            std::cout << (std::exchange(printed_, true) ? "\n" : "") << text << std::flush;
        }
    }

    static constexpr std::size_t all_lines = 10'000;

    const Common& common_;
    const Options options_;
    Caller caller_;
    const bool redraw_;
    std::optional<Look> before_, last_;
    LiveText live_text_;
    ConnectionReporter reporter_;
    bool printed_ = false;
};

} // namespace

void add_top_command(command_line::Command& app, const Common& common) {
    auto& top =
        app.add_command("top", "Show metrics of the server: ticks, clients, bytes, disk, memory").group("Follow");
    auto& options = top.keep(Options{});
    top.add_option("--interval", &options.interval_s, "Seconds between two measurements")
        .check(command_line::RealNumber{0.1, 3600})
        .show_default();
    top.add_flag("--once", &options.once, "Measure twice, print one page, then exit");
    top.footer(
        "Rates are averages since the previous measurement. With --json every measurement is one line; with --once\n"
        "too, the first one is printed immediately.\n\n"
        "Examples:\n  evoctl top\n  evoctl top --once\n  evoctl --json top --interval 60 >> metrics.jsonl");
    top.action([&] { Top{common, options}.run(); });
}

} // namespace evod::ctl
